"""Write the simulated recording data/mittermaier2016/simulated_iq* again, bit for bit."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from dopplerlib.systems.mittermaier2016 import write_simulated_iq
from dopplerlib.systems.mittermaier2016.published import DATA

if __name__ == "__main__":
    for path in write_simulated_iq(DATA):
        print(path.relative_to(DATA.parent))
