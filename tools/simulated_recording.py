"""Write the simulated recording data/mittermaier2016/simulated_iq* again, bit for bit."""

from dopplerlib.systems.mittermaier2016 import write_simulated_iq
from dopplerlib.systems.mittermaier2016.published import DATA

if __name__ == "__main__":
    for path in write_simulated_iq(DATA):
        print(path.relative_to(DATA.parent))
