"""Derive the formulas and print the numerical kernels, dopplerlib/kernels."""

from dopplerlib.derive import __main__ as derive
from tools.command import parser, start


def main(argv=None):
    """Write the kernels."""
    parser(__doc__).parse_args(argv)
    derive.main()


if __name__ == "__main__":
    start(main)
