"""``python -m dopplerlib RECORDING ... --array ARRAY.toml``."""

import sys

from .commandline.main import main

if __name__ == "__main__":
    sys.exit(main())
