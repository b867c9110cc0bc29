"""Build the book, and show how far it is."""

import re
import sys
from pathlib import Path
from subprocess import PIPE

from tools.alone import alone
from tools.command import child, parser, start

BOOK = Path(__file__).resolve().parent.parent / "book"
# Warnings are errors, and a reference to nowhere is a warning.
BUILD = ["build", "--all", "-W", "-n", "--keep-going", str(BOOK)]
STEP = re.compile(r"(\w[\w ]*)\.\.\. *\[ *(\d+)%\]")


def main(argv=None):
    """Build it; return the exit code of the builder, whose warnings go to standard error."""
    parser(__doc__).parse_args(argv)
    command = [sys.executable, "-c", "from jupyter_book.cli.main import main; main()", *BUILD]
    shown = None
    with (
        alone(BOOK / "_build" / ".lock", "the book") as lock,
        child(command, pass_fds=[lock], stdout=PIPE, text=True, errors="replace") as builder,
    ):
        for line in builder.stdout:
            step = STEP.search(line)
            if step and step.groups() != shown:
                shown = step.groups()
                print(f"\rbook: {shown[0]} {shown[1]:>3} % ", end="", file=sys.stderr, flush=True)
        code = builder.wait()
    print(file=sys.stderr)
    if not code:
        print(BOOK / "_build" / "html" / "index.html")
    return code


if __name__ == "__main__":
    start(main)
