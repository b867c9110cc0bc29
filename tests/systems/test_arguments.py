"""What every function of the systems asks of the number of runs and of the source of randomness."""

import inspect
import pkgutil
from importlib import import_module

import numpy as np
import pytest

import dopplerlib.systems

NOT_WHOLE = ("x", 0, -1, 1.5, True, None, np.nan, np.timedelta64(2, "s"), [2])
NO_GENERATOR = (5, None, "x", 1.5, np.random)


def functions():
    """Yield the public functions that can be called with `runs` and `rng` alone."""
    for found in pkgutil.walk_packages(dopplerlib.systems.__path__, "dopplerlib.systems."):
        if "._" in found.name:
            continue
        module = import_module(found.name)
        for name, value in list(vars(module).items()):
            here = inspect.isfunction(value) and value.__module__ == module.__name__
            if not here or name.startswith("_"):
                continue
            parameters = inspect.signature(value).parameters
            needed = {key for key, each in parameters.items() if each.default is each.empty}
            if "rng" in needed and needed <= {"runs", "rng"}:
                yield pytest.param(value, id=f"{found.name.split('.')[2]}.{name}")


FUNCTIONS = list(functions())


def test_the_functions_are_found():
    assert len(FUNCTIONS) >= 15


@pytest.mark.parametrize("function", FUNCTIONS)
def test_a_number_of_runs_is_whole_and_positive(function):
    if "runs" not in inspect.signature(function).parameters:
        pytest.skip("the number of runs is not asked for")
    for runs in NOT_WHOLE:
        with pytest.raises(ValueError, match=r"^runs must be a whole number of at least"):
            function(runs=runs, rng=np.random.default_rng(1))


@pytest.mark.parametrize("function", FUNCTIONS)
def test_randomness_comes_from_a_generator(function):
    runs = {"runs": 2} if "runs" in inspect.signature(function).parameters else {}
    for rng in NO_GENERATOR:
        with pytest.raises(ValueError, match=r"^rng must be a numpy\.random\.Generator"):
            function(**runs, rng=rng)
