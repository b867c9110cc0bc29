"""Medians, means and shares are shown with two digits and their interval."""

from dopplerlib.replication.interval_table import IntervalTable


def test_a_table_shows_two_digits_and_powers_of_ten():
    table = IntervalTable({"a": {"q": [123456.0] * 20}, "b": {"q": [0.0123] * 20}})
    assert table._repr_markdown_().splitlines() == [
        "|  | q |",
        "| --- | --- |",
        "| a | 1.2·10⁵<br>(1.2·10⁵ to 1.2·10⁵) |",
        "| b | 0.012<br>(0.012 to 0.012) |",
    ]
    numbers = {"c": {"q": [280.0] * 20}, "d": {"q": [6.04] * 20}, "e": {"q": [15.2] * 20}}
    cells = IntervalTable(numbers)._repr_markdown_()
    assert all(text in cells for text in ("280<", "6.0<", "15<"))


def test_means_and_shares_are_shown_where_medians_say_little():
    rows = {"a": {"q": [0.0] * 9 + [10.0], "lost": [False] * 9 + [True]}}
    cells = IntervalTable(rows, "mean")._repr_markdown_().splitlines()[2]
    # Mean 1 and standard error 1, times the quantile 2.26 of Student's t; Clopper-Pearson for 1 of
    # 10.
    assert cells == "| a | 1.0<br>(-1.3 to 3.3) | 0.10<br>(0.0025 to 0.45) |"
    assert repr(IntervalTable(rows, "mean")) == "means of 1 variants"
    median = IntervalTable(rows)._repr_markdown_().splitlines()[2]
    assert median.startswith("| a | 0.0<br>(0.0 to ")
