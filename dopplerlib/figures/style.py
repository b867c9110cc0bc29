"""Parts of all figures: the style file, the colors by meaning, and a fresh figure."""

import inspect
import re
from collections.abc import Callable
from functools import wraps
from importlib.resources import as_file, files
from typing import Any, Concatenate, ParamSpec

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .._hints import checked

_P = ParamSpec("_P")
_HYPHEN = re.compile(r"(?<![^\s(])-(?=\d)")
STYLE = files(__package__) / "style.mplstyle"

# One meaning, one color, all through the book.
OURS = "#0072B2"
PUBLISHED = "#D55E00"
TRUTH = "#222222"
SENSOR = "#009E73"
BOUND = "#777777"
MEASURED = "#999999"  # what a radar says, beside what a filter makes of it

# Colors of the palette without a meaning, for what a single figure compares.
ORANGE, PINK, SKY = "#E69F00", "#CC79A7", "#56B4E9"
# Variants of one filter, each with its own line for print in gray.
VARIANTS = ((OURS, "-"), (ORANGE, "--"), (PINK, "-."), (TRUTH, ":"))
# Sensors in their order, all of the hue that means "sensor": dark to light, and labeled as well.
_SHADES = ("#00382A", "#005B44", "#007A5B", "#009E73", "#45B894", "#7CCDB2")
LABEL = {"textcoords": "offset points", "ha": "center", "va": "center"}
HALO = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}


def drawing(width: float = 7.0, height: float = 4.0):
    """Make a function that draws on a figure one that returns a new figure of this size in inches.

    The function gets the figure, in the style of the book, as its first argument; the others are
    checked by their hints. A hyphen before a number becomes the minus that the axes have. The
    figure is labeled with the name of the function, and not registered with pyplot: the caller
    alone holds it.
    """

    def decorate(draw: Callable[Concatenate[Figure, _P], None]) -> Callable[_P, Figure]:
        def new(*args, **kwargs):
            with as_file(STYLE) as path, plt.style.context(path):
                figure = plt.figure(figsize=(width, height))
                figure.set_label(draw.__name__)
                plt.close(figure)
                draw(figure, *args, **kwargs)
                for text in figure.findobj(Text):
                    text.set_text(_HYPHEN.sub("\N{MINUS SIGN}", text.get_text()))
            return figure

        made: Any = wraps(draw)(new)
        signature = inspect.signature(draw)
        _, *others = signature.parameters.values()
        made.__signature__ = signature.replace(parameters=others, return_annotation=Figure)
        hints = {name: hint for name, hint in draw.__annotations__.items() if name != "figure"}
        made.__annotations__ = hints | {"return": Figure}
        return checked(made)

    return decorate


def looks(labels, words):
    """Return color, line and mark by label, so that a thing has one look in all figures.

    labels: Of the curves of a figure.
    words: Color, line and mark by word: the first word that is in a label decides. A second label
        of the same color is dotted.
    """
    found, used = {}, set()
    for label in labels:
        color, line, mark = next(look for word, look in words.items() if word in label)
        found[label] = (color, ":", "D") if color in used else (color, line, mark)
        used.add(color)
    return found


def plain_log_ticks(axis):
    """Label 1, 2 and 5 times the powers of ten of a logarithmic axis with plain numbers.

    axis: Axis with a logarithmic scale that spans about a decade, where powers of ten alone are too
        few.
    """
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def sensor_colors(n):
    """Return `n` colors for sensors 1 to n, from dark to light."""
    return [_SHADES[i * len(_SHADES) // n] for i in range(n)]


def ink(color):
    """Return "black" or "white", whichever stands out more from a color (red, green, blue, ...).

    The contrast of WCAG 2.1, (bright + 0.05) / (dark + 0.05), is the same for both at the relative
    luminance sqrt(1.05 * 0.05) - 0.05.
    """
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color[:3]]
    luminance = np.dot(linear, [0.2126, 0.7152, 0.0722])
    return "black" if luminance > np.sqrt(1.05 * 0.05) - 0.05 else "white"


def project(points, azimuth, elevation):
    """Return the orthographic view of `points`, shape (..., 3), as (..., 2): right and up.

    points (..., 3): Positions in m, z upwards.
    azimuth, elevation: From where they are seen, in degrees; azimuth from +x towards +y.
    """
    a, e = np.deg2rad([azimuth, elevation])
    right = [-np.sin(a), np.cos(a), 0]
    up = [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)]
    return np.asarray(points) @ np.transpose([right, up])


def spread(values, gap):
    """Return `values` moved apart as little as needed so that no two are closer than `gap`.

    Labels at the ends of neighboring curves would otherwise cover each other.
    """
    values = np.asarray(values, float)
    order = np.argsort(values, kind="stable")
    moved = values[order]
    for _ in range(100 * len(moved)):
        short = gap - np.diff(moved)
        if (short <= 1e-9 * gap).all():
            break
        push = np.maximum(short, 0) / 2
        moved[:-1] -= push
        moved[1:] += push
    result = np.empty_like(moved)
    result[order] = moved
    return result


def arrow(ax, start, vector, color, text, offset=(0, 10)):
    """Draw an arrow from `start` along `vector`, with `text` at its middle, `offset` points off."""
    end = np.add(start, vector)
    style = {"arrowstyle": "-|>", "lw": 2, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 13}
    ax.annotate("", end, start, arrowprops={**style, "color": color})
    ax.annotate(text, (np.asarray(start) + end) / 2, offset, color=color, bbox=HALO, **LABEL)


def doppler_lines(ax, time, shifts, names=None):
    """Draw one Doppler curve for each sensor, labeled at its end."""
    n = shifts.shape[-1]
    names = [str(i + 1) for i in range(n)] if names is None else names
    height = np.ptp(shifts) or 1.0
    heights = spread(shifts[-1], 0.075 * height)
    for curve, color, name, end in zip(shifts.T, sensor_colors(n), names, heights, strict=True):
        ax.plot(time, curve, color=color, label=name)
        ax.annotate(
            name,
            (time[-1], curve[-1]),
            (time[-1] + 0.05 * np.ptp(time), end),
            color=TRUTH,
            va="center",
            arrowprops={"arrowstyle": "-", "color": color, "lw": 0.6, "shrinkA": 0, "shrinkB": 0},
        )
    ax.set(xlabel="time (s)", ylabel="Doppler shift (Hz)")
    ax.margins(x=0)
