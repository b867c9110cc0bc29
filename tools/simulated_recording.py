"""Write the simulated recording data/mittermaier2016/simulated_iq* again, bit for bit."""

from dopplerlib.systems.mittermaier2016 import write_simulated_iq
from dopplerlib.systems.mittermaier2016.published import data_file
from tools.command import parser, start


def main(argv=None):
    """Write the files and name them."""
    parser(__doc__).parse_args(argv)
    for path in write_simulated_iq(data_file()):
        print(path.name)


if __name__ == "__main__":
    start(main)
