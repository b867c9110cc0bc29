"""What holds for the figures of every module."""

import matplotlib.pyplot as plt


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
