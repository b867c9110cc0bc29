"""The figures of the derivation show the numbers that they are given."""

import numpy as np

from dopplerlib.figures import derivation

MADE_UP = {"derivative_errors"}


def curves(figure):
    """Return the curves of the only axes by label."""
    (ax,) = figure.axes
    return {line.get_label(): line for line in ax.get_lines() if line.get_label()[0] != "_"}


def test_every_printed_form_has_a_box_and_an_arrow():
    stages, products = ["Eq 6", "code"], ["Python", "C99", "LaTeX"]
    (ax,) = derivation.one_text(stages, products).axes
    assert sorted(text.get_text() for text in ax.texts) == sorted(stages + products)
    assert len(ax.patches) == 5 + 1 + 3  # boxes, from stage to stage, to each form


def test_derivative_errors_are_drawn_as_they_are_but_never_below_one_rounding():
    step = np.array([1e-8, 1e-4, 1e-1])
    errors = {"exact": np.array([0.0, 1e-20, 1e-3]), "other": np.array([1e-8, 1e-9, 1e-2])}
    figure = derivation.derivative_errors(step, errors)
    drawn = curves(figure)
    assert drawn["exact"].get_ydata().tolist() == [2.0**-53, 2.0**-53, 1e-3]
    assert drawn["other"].get_ydata().tolist() == [1e-8, 1e-9, 1e-2]


def test_position_errors_show_the_median_and_the_central_95_percent_of_the_runs():
    # Runs 1 to 201, in m: the quantiles 0.025, 0.5 and 0.975 are runs 6, 101 and 196.
    runs = np.random.default_rng(3).permutation(np.arange(1.0, 202.0))
    errors = {"a": np.outer(runs, [1.0, 2.0]), "b": np.outer(runs, [3.0, 4.0])}
    figure = derivation.position_errors(np.array([0.0, 1.0]), errors)
    drawn = curves(figure)
    assert np.allclose(drawn["a"].get_ydata(), [101.0, 202.0])
    assert np.allclose(drawn["b"].get_ydata(), [303.0, 404.0])
    band = figure.axes[0].collections[0].get_paths()[0].vertices[:, 1]
    assert np.allclose([band.min(), band.max()], [6.0, 392.0])
