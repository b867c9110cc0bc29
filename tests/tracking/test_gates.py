"""A chi-square gate lets the target through with its probability; a box has none."""

import numpy as np
import pytest
from scipy.stats import chi2

from dopplerlib.tracking.gates import chi2_gate, fixed_box_gate


@pytest.mark.parametrize("probability", [0.5, 0.99, 0.999999])
def test_with_two_components_the_gate_ends_at_a_logarithm(probability):
    """P(chi2 with 2 degrees of freedom > d) = exp(-d / 2)."""
    edge = -2 * np.log(1 - probability)
    inside = chi2_gate(edge * np.array([1 - 1e-9, 1 + 1e-9]), 2, probability)
    assert inside.tolist() == [True, False]


def test_the_gate_ends_at_the_quantile_for_any_number_of_components():
    for m in (1, 3, 6):
        edge = chi2.ppf(0.99, m)
        assert chi2_gate([edge * (1 - 1e-9), edge * (1 + 1e-9)], m, 0.99).tolist() == [True, False]


def test_what_was_not_measured_is_outside():
    assert not chi2_gate(np.nan, 3, 0.99)
    assert not fixed_box_gate([np.nan, 0.0], [1.0, 1.0])


def test_a_box_asks_for_every_component():
    innovation = np.array([[0.9, -1.9], [-1.1, 0.0], [0.0, 2.1]])
    assert fixed_box_gate(innovation, [1.0, 2.0]).tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("function", "arguments", "name"),
    [
        (chi2_gate, (1.0, 0, 0.9), "m"),
        (chi2_gate, (1.0, 2, 1.0), "gate_probability"),
        (chi2_gate, ("a", 2, 0.9), "nis"),
        (fixed_box_gate, ([0.0, 0.0], [1.0, -1.0]), "half_widths"),
        (fixed_box_gate, ([0.0], [1.0, 1.0]), "innovation"),
    ],
)
def test_bad_input_is_named(function, arguments, name):
    with pytest.raises(ValueError, match=rf"^{name} must "):
        function(*arguments)
