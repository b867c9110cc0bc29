"""Tables of results: what a cell shows, on a page and as text."""

import numpy as np
import pytest

from dopplerlib import Table
from dopplerlib.evaluation.intervals import ConfidenceInterval

ERRORS = Table(
    {"ours": (0.024, 1.9, 3), "paper": (float("nan"), 0.25, "none")},
    ("x (cm)", "y (cm)", "runs"),
    digits=(2, 1, 0),
    corner="error",
)


def test_columns_of_text_are_aligned_and_numbers_have_their_decimals():
    assert str(ERRORS).split("\n") == [
        "error  x (cm)  y (cm)  runs",
        "ours     0.02     1.9     3",
        "paper       –     0.2  none",
    ]


def test_the_page_has_the_same_cells_and_says_which_are_heads():
    html = ERRORS._repr_html_()
    assert html.count('scope="row"') == 2
    assert html.count('scope="col"') == 4
    for row in ERRORS.cells:
        for cell in row:
            assert f">{cell}</t" in html


def test_what_looks_like_markup_is_shown_as_it_is():
    html = Table({"a < b": ("<script>",)}, ("x & y",), corner='"')._repr_html_()
    assert "<script>" not in html
    assert "a &lt; b" in html
    assert "x &amp; y" in html


def test_whole_numbers_have_no_decimals_and_labels_may_be_numbers():
    values = (7, np.int64(8), np.float64(0.5), np.float32(0.25))
    table = Table({0.1: values}, tuple("abcd"), digits=2)
    assert table.cells[1] == ["0.1", "7", "8", "0.50", "0.25"]


def test_a_format_says_how_numbers_and_intervals_are_written():
    rows = {
        "a": (
            0.123456,
            ConfidenceInterval(2.0, 1.5, 2.75),
            ConfidenceInterval(0.5, 0.25, 0.75),
            12345,
        )
    }
    table = Table(rows, tuple("wxyz"), (".1e", 2, "±.3f", ".3g"))
    assert table.cells[1] == ["a", "1.2e-01", "2.00 (1.50 to 2.75)", "0.500 ± 0.250", "1.23e+04"]
    signed = Table({"a": ConfidenceInterval(0.5, 0.25, 0.75)}, digits="±+.2f")
    assert signed.cells == [["a", "+0.50 ± 0.25"]]
    assert Table({"a": ConfidenceInterval(0.5, 0.25, 0.75)}, digits=".0%").cells == [
        ["a", "50% (25% to 75%)"]
    ]


def test_what_rounds_to_zero_has_no_sign_and_an_open_interval_says_so():
    cells = (-1e-17, ConfidenceInterval(1.0, -np.inf, np.inf), np.inf)
    assert Table({"a": cells}, tuple("xyz"), 1).cells[1] == ["a", "0.0", "1.0 (-∞ to ∞)", "∞"]


def test_facts_need_no_head_and_may_have_their_own_digits():
    facts = Table({"distance (m)": 1.25, "samples": 10, "consistent": np.True_}, digits={
        "distance (m)": 1
    })  # fmt: skip
    assert facts.cells == [["distance (m)", "1.2"], ["samples", "10"], ["consistent", "yes"]]
    assert "<thead>" not in facts._repr_html_()
    assert facts._repr_html_().count('scope="row"') == 3


def test_rows_may_be_arrays():
    assert Table({"x": np.array([1.26, 2.0])}, ("a", "b"), digits=1).cells[1] == ["x", "1.3", "2.0"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rows": {}}, "rows must be a dict with at least one row, got {}"),
        ({"rows": [1, 2]}, r"rows must be a dict with at least one row, got \[1, 2\]"),
        ({"rows": {"a": (1,)}}, r"rows\['a'\] must have 2 values, one for each column, got 1"),
        ({"rows": {"a": 3}}, r"rows\['a'\] must be a sequence of values, got 3"),
        ({"rows": {"a": (1, None)}}, r"rows\['a'\] must .*None"),
        ({"rows": {"a": (1, [2, 3])}}, r"rows\['a'\] must .*\[2, 3\]"),
        ({"columns": ("x", 2)}, "columns must be .*2"),
        ({"digits": (1, 2, 3)}, "digits must be one or 2, one for each column, got 3"),
        ({"digits": -1}, "digits must be a whole number of at least 0, got -1"),
        ({"digits": "much"}, "digits must be decimals or a format, got 'much'"),
        ({"digits": {"b": 1}}, "digits must be by labels of rows, got 'b'"),
        ({"rows": {1: (1, 2), "1": (1, 2)}}, "rows must have labels .*'1' twice"),
        ({"corner": None}, "corner must be a str, got None"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(change, message):
    good = {"rows": {"a": (1, 2)}, "columns": ("x", "y"), "digits": 1, "corner": ""}
    with pytest.raises(ValueError, match=message):
        Table(**good | change)


def test_equal_tables_are_equal_and_stay_as_they_are():
    one, two = (Table({"a": (1.0,)}, ("x",)) for _ in range(2))
    assert one == two
    with pytest.raises(AttributeError):
        one.corner = "b"
