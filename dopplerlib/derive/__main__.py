"""Write `dopplerlib.kernels`: ``python -m dopplerlib.derive``."""

import os
from pathlib import Path

from .sources import kernel_sources

KERNELS = Path(__file__).parents[1] / "kernels"


def main():
    """Replace every kernel in one step: an interrupted run leaves whole files."""
    for name, text in kernel_sources().items():
        unfinished = KERNELS / f"{name}.tmp"
        unfinished.write_text(text, encoding="utf-8", newline="\n")
        os.replace(unfinished, KERNELS / name)
        print(f"dopplerlib/kernels/{name}")


if __name__ == "__main__":
    main()
