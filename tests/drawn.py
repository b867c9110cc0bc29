"""What holds for the figures of every module."""

import re

import matplotlib.pyplot as plt

# What a label of a quantity without a unit speaks of.
_PURE = (
    r"\b(NIS|NEES|amplitude|autocorrelation|cee|correlation|degrees of freedom|fraction|number|"
    r"probability|ratio|relative|runs|samples|sum)\b"
)


def check_figures(module, figures):
    """Fail if a public function of the module has no figure, or one does not fit a page.

    `figures` has a figure by the name of each function.
    """
    public = {
        name
        for name, value in vars(module).items()
        if getattr(value, "__module__", "") == module.__name__ and not name.startswith("_")
    }
    assert public == set(figures)
    for name, figure in figures.items():
        assert figure.get_figwidth() <= 7, name
        figure.canvas.draw()
    assert plt.get_fignums() == []


def labels(figure):
    """Return the labels of all axes of a figure that are shown."""
    axes = [ax for ax in figure.axes if ax.axison and ax.get_visible()]
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
