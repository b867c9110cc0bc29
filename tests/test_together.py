"""The loop over small cases: it goes on after a failure, and names every case that failed."""

import pytest

from tests.together import each


def test_all_cases_that_fail_are_named():
    def check(name, number):
        if number == 2:
            pytest.fail("two")
        assert number != 3

    each([("a", 1), ("b", 4)], check)
    with pytest.raises(BaseExceptionGroup, match="2 cases") as raised:
        each([("a", 1), ("b", 2), ("c", 3), ("d", 4)], check)
    notes = [error.__notes__ for error in raised.value.exceptions]
    assert notes == [["case: ('b', 2)"], ["case: ('c', 3)"]]
