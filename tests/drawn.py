"""What holds for the figures of every module."""

import inspect
import re
from importlib import import_module
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.colors import to_rgb, to_rgba_array
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from dopplerlib import figures
from dopplerlib.figures.style import PUBLISHED

MODULES = sorted({path.stem for path in Path(figures.__path__[0]).glob("[!_]*.py")} - {"style"})

SMALLEST = 8  # points: 12 px on a page that shows a figure of seven inches at full width
SLACK = 2  # px: boxes of letters have air around them
NEAR = 12  # px: a mark this close above or beside a legend reads as one of its entries
PALE = 2.2  # contrast below which letters on white are hard to read, even beside a bold line
RENDERER = RendererAgg(1120, 1120, 160)  # px, and dots in an inch, as in the style of the book
# Whose a curve in the color of what is published may be.
_THEIRS = re.compile(r"\b(publish|paper|thesis|report|document|Table|Fig|Eq)")

# What a label of a quantity without a unit speaks of.
_PURE = (
    r"\b(NIS|NEES|amplitude|autocorrelation|cee|correlation|degrees of freedom|fraction|number|"
    r"probability|ratio|relative|runs|samples|sum)\b"
)


def drawings(module):
    """Return the public functions of a module of figures by name."""
    return {
        name: function
        for name, function in vars(import_module(f"dopplerlib.figures.{module}")).items()
        if inspect.isfunction(function)
        and function.__module__.endswith(f".{module}")
        and not name.startswith("_")
    }


def check_figure(figure):
    """Fail if a figure does not fit a page, or a text of it cannot be read or lacks its unit."""
    name = figure.get_label()
    assert figure.get_figwidth() == 7, name  # all pages show it equally large: so do letters
    lay_out(figure)
    written = [text for text in figure.findobj(Text) if text.get_text().strip()]
    check_labels(figure)
    check_colors(figure, written)
    assert small(written) == pale(written) == [], name
    assert overlaps(figure, written) == [], name


def lay_out(figure):
    """Find out where everything is drawn."""
    # One renderer for all figures remembers the sizes of words.
    figure.canvas.get_renderer = lambda: RENDERER
    with RENDERER._draw_disabled():
        figure.draw(RENDERER)


def _axes(figure):
    """Return the axes of a figure, those inside others as well, which show another unit."""
    return [one for ax in figure.axes for one in (ax, *ax.child_axes)]


def _shown(figure, written):
    """Return which texts of a laid out figure are drawn."""
    hidden = set()
    for axis in (getattr(ax, f"{name}axis") for ax in _axes(figure) for name in ax._axis_names):
        low, high = sorted(axis.get_view_interval())
        for tick in axis.get_major_ticks() + axis.get_minor_ticks():
            if not low <= tick.get_loc() <= high:  # beyond the view: not drawn
                hidden |= {tick.label1, tick.label2}
        if not (axis.axes.axison and axis.axes.get_visible()):
            hidden |= set(axis.findobj(Text))
    return [text for text in written if text.get_visible() and text not in hidden]


def small(written):
    """Return the texts that a reader has to come closer for."""
    return [
        text.get_text() for text in written if text.get_visible() and text.get_fontsize() < SMALLEST
    ]


def pale(written):
    """Return the texts that hardly stand out from the white of the page."""

    def contrast(color):
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color[:3]]
        return 1.05 / (np.dot(linear, [0.2126, 0.7152, 0.0722]) + 0.05)

    levels = {text.get_text(): contrast(to_rgb(text.get_color())) for text in written}
    return [text for text, level in levels.items() if 1 < level < PALE]  # white is on something


def check_colors(figure, written):
    """Fail if something has the color of what is published, and the figure names no document."""
    artists = [artist for ax in figure.axes for artist in (*ax.lines, *ax.collections, *ax.patches)]
    colors = [
        np.atleast_2d(to_rgba_array(getattr(artist, f"get_{part}")()))
        for artist in artists
        for part in ("color", "edgecolor", "facecolor")
        if hasattr(artist, f"get_{part}")
    ]
    theirs = any((to_rgb(PUBLISHED) == one[:, :3]).all(axis=1).any() for one in colors if one.size)
    assert not theirs or any(_THEIRS.search(text.get_text()) for text in written)


def overlaps(figure, written):
    """Return the pairs of texts of a laid out figure that lie on each other."""
    found = _shown(figure, written)
    boxes = [text.get_window_extent(RENDERER).extents for text in found]
    ends = np.reshape(boxes, (-1, 2, 2))
    common = np.minimum(ends[:, None, 1], ends[:, 1]) - np.maximum(ends[:, None, 0], ends[:, 0])
    pairs = np.argwhere(np.triu((common > SLACK).all(axis=-1), 1))
    return [(found[i].get_text(), found[j].get_text()) for i, j in pairs]


def covered(figure):
    """Return the labels of lines of a laid out figure that run through a legend of their axes."""
    found = []
    for ax in figure.axes:
        if (legend := ax.get_legend()) is None:
            continue
        box = Bbox.intersection(legend.get_window_extent().padded(-SLACK), ax.bbox)
        if box is None:
            continue
        near = legend.get_window_extent().padded(NEAR)
        for line in ax.lines:
            path = line.get_path().transformed(line.get_transform())
            joined = line.get_linestyle() != "None"
            meets = path.intersects_bbox(box, filled=False) if joined else False
            alone = not joined and len(path.vertices) == 1  # it looks like an entry
            area = near if alone else box
            if line.get_visible() and (meets or area.count_contains(path.vertices)):
                found.append(line.get_label())
    return found


def labels(figure):
    """Return the labels of all axes of a figure that are shown."""
    axes = [ax for ax in _axes(figure) if ax.axison and ax.get_visible()]
    every = [getattr(ax, f"get_{name}label", str)() for ax in axes for name in "xyz"]
    return [label for label in [*every, figure.get_supxlabel(), figure.get_supylabel()] if label]


def check_labels(figure):
    """Fail if a label has no unit in parentheses at its end, unless its quantity has none."""
    for label in labels(figure):
        assert re.search(r"\S \([^()]+\)$", label) or re.search(_PURE, label), label


def lines(ax):
    """Return {label: line} of the lines of an axes that have a label."""
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def check_legends(figure):
    """Fail if a legend does not name just what is drawn with a label."""
    legends = [*figure.legends, *(ax.get_legend() for ax in figure.axes if ax.get_legend())]
    told = {text.get_text() for legend in legends for text in legend.get_texts()}
    drawn = {label for ax in figure.axes for label in ax.get_legend_handles_labels()[1]}
    assert drawn
    assert drawn == told
