"""The test that each test file of this folder runs on the functions of one package."""

import pytest

from .run import fuzz
from .targets import discover

EXAMPLES = 200  # odd calls of each function, the same ones every time
OF_ROOMS = 40  # of the functions of one document, which take much longer; `make fuzz` makes more
SECONDS = 0.5  # for those of one function; what takes longer gets fewer of them


def of_package(package):
    """Return a test, for each public function of a package of the library, of odd calls."""
    targets = discover(f"dopplerlib.{package}")
    examples = OF_ROOMS if package.startswith("systems.") else EXAMPLES

    @pytest.mark.parametrize("target", targets, ids=lambda target: target.name)
    def test_odd_arguments_are_refused_by_name_or_give_finite_results(target):
        outcome = fuzz(target, examples, seconds=SECONDS)
        assert not outcome.bad, "\n".join(outcome.bad)

    return test_odd_arguments_are_refused_by_name_or_give_finite_results
