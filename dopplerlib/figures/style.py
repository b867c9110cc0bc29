"""What all figures share: the style file, the colors by meaning, and a fresh figure."""

from contextlib import contextmanager
from importlib.resources import as_file, files

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

STYLE = files(__package__) / "style.mplstyle"

# One meaning, one color, all through the book.
OURS = "#0072B2"
PUBLISHED = "#D55E00"
TRUTH = "#222222"
SENSOR = "#009E73"
BOUND = "#777777"
MEASURED = "#999999"  # what a radar says, beside what a filter makes of it

# Colors of the palette without a meaning, for what a single figure compares.
ORANGE, PINK = "#E69F00", "#CC79A7"
# Variants of one filter, each with its own line for print in gray.
VARIANTS = ((OURS, "-"), (ORANGE, "--"), (PINK, "-."), (TRUTH, ":"))


@contextmanager
def styled(width=7.0, height=4.0):
    """Give a new figure in the style of the book, of this size in inches.

    The figure is not registered with pyplot: the function that made it returns it, and nothing
    else holds it.
    """
    with as_file(STYLE) as path, plt.style.context(path):
        figure = plt.figure(figsize=(width, height))
        plt.close(figure)
        yield figure


def plain_log_ticks(axis):
    """Label 1, 2 and 5 times the powers of ten of a logarithmic axis with plain numbers.

    Parameters
    ----------
    axis : matplotlib.axis.Axis
        Axis with a logarithmic scale that spans about a decade, where powers of ten alone are too
        few.
    """
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
