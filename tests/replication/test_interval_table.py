"""Medians, means and fractions are shown with two digits and their interval."""

import pytest

from dopplerlib.replication.interval_table import interval_table


def test_a_table_shows_two_digits_and_powers_of_ten():
    table = interval_table({"a": {"q": [123456.0] * 20}, "b": {"q": [0.0123] * 20}})
    assert table.cells == [
        ["median, 95 %", "q"],
        ["a", "1.2·10⁵ (1.2·10⁵ to 1.2·10⁵)"],
        ["b", "0.012 (0.012 to 0.012)"],
    ]
    numbers = {"c": {"q": [280.0] * 20}, "d": {"q": [6.04] * 20}, "e": {"q": [15.2] * 20}}
    text = str(interval_table(numbers))
    assert all(number in text for number in ("280 (", "6.0 (", "15 ("))


def test_means_and_fractions_are_shown_where_medians_say_little():
    rows = {"a": {"q": [0.0] * 9 + [10.0], "lost": [False] * 9 + [True]}}
    # Mean 1 and standard error 1, times the quantile 2.26 of Student's t; Clopper-Pearson for 1 of
    # 10.
    cells = interval_table(rows, "mean").cells
    assert cells[1] == ["a", "1.0 (-1.3 to 3.3)", "0.10 (0.0025 to 0.45)"]
    assert interval_table(rows).cells[1][1].startswith("0.0 (0.0 to ")


def test_quantities_are_found_by_their_names_and_not_by_their_order():
    rows = {"a": {"p": [1.0] * 9, "q": [2.0] * 9}, "b": {"q": [2.0] * 9, "p": [1.0] * 9}}
    first, second = interval_table(rows).cells[1:]
    assert first[1:] == second[1:]


def test_a_transposed_table_has_the_same_cells():
    rows = {"a": {"p": [1.0] * 9, "q": [2.0] * 9}, "b": {"p": [3.0] * 9, "q": [4.0] * 9}}
    (corner, *names), *plain = interval_table(rows).cells
    assert interval_table(rows, transposed=True).cells == [
        [corner, "a", "b"],
        *([name, *(row[i] for row in plain)] for i, name in enumerate(names, 1)),
    ]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ({}, "rows must hold a quantity of a variant, got {}"),
        ({"a": {}}, "rows must hold a quantity"),
        ({"a": {"p": [1.0]}, "b": {"q": [1.0]}}, r"rows must hold the same .* \['p'\] and \['q'\]"),
    ],
)
def test_what_is_no_table_is_refused(rows, message):
    with pytest.raises(ValueError, match=message):
        interval_table(rows)
