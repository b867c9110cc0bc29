"""Build the book, and show how far it is."""

import gc
import re
import sys
from contextlib import redirect_stdout
from pathlib import Path

from tools.alone import alone
from tools.command import end_at_once, parser, start

BOOK = Path(__file__).resolve().parent.parent / "book"
# Warnings are errors, and a reference to nowhere is a warning.
BUILD = ["build", "--all", "-W", "-n", "--keep-going", str(BOOK)]
STEP = re.compile(r"(\w[\w ]*)\.\.\. *\[ *(\d+)%\]")


class Progress:
    """Stands in for the standard output of the builder, whose every line is a step."""

    def __init__(self):
        self.shown = None

    def write(self, text):
        """Show the step on standard error, if it is another one."""
        step = STEP.search(text)
        if step and step.groups() != self.shown:
            self.shown = step.groups()
            sys.stderr.write("\rbook: {:24} {:>3} % ".format(*self.shown))
            sys.stderr.flush()

    def flush(self):
        """Do nothing: what is shown is shown at once."""


def main(argv=None):
    """Build it; return the exit code of the builder, whose warnings go to standard error."""
    parser(__doc__).parse_args(argv)
    from jupyter_book.cli.main import main as build  # here: it warns of what it imports

    # Seldom, and hardly ever among all that has been read. Not at all would take gigabytes, since
    # the trees of pages refer to themselves.
    gc.set_threshold(200_000, 10, 1000)
    end_at_once()  # the builder would take an interruption for a failure of its own
    with alone(BOOK / "_build" / ".lock", "the book"):
        try:
            with redirect_stdout(Progress()):
                build(BUILD)
        except SystemExit as end:
            code = end.code
    print(file=sys.stderr)
    if not code:
        print(BOOK / "_build" / "html" / "index.html")
    return code


if __name__ == "__main__":
    start(main)
