"""Write the simulated recording data/mittermaier2016/simulated_iq* again, bit for bit."""

from dopplerlib.systems.mittermaier2016 import write_simulated_iq
from dopplerlib.systems.mittermaier2016.published import data_file

if __name__ == "__main__":
    for path in write_simulated_iq(data_file()):
        print(path.relative_to(data_file().parent))
