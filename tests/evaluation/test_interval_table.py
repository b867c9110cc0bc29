"""Medians are shown with two digits and their interval."""

from dopplerlib.evaluation.interval_table import IntervalTable


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
