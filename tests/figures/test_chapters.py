"""Figures and chapters go one to one, and every drawing has the same form."""

import inspect
import re
from pathlib import Path
from typing import get_args, get_origin, get_type_hints

import numpy as np
import pytest

from dopplerlib import _hints
from tests.drawn import MODULES, drawings
from tools.notebooks import chapters, stored_cells

CODE = {
    path.stem: "\n".join(c.source for c in stored_cells(path) if c.cell_type == "code")
    for path in chapters()
}
IMPORT = re.compile(r"from dopplerlib\.figures(?:\.(\w+))? import (.+)")


@pytest.mark.parametrize("module", MODULES)
def test_a_module_of_figures_has_its_tests_and_its_chapter_that_calls_it_draw(module):
    assert Path(__file__).with_name(f"test_{module}.py").exists()
    wanted = f"from dopplerlib.figures import {module} as draw"
    assert CODE[module].count(wanted) == 1


@pytest.mark.parametrize("chapter", CODE)
def test_a_chapter_draws_with_the_module_of_its_name_or_borrows_a_function(chapter):
    for module, names in IMPORT.findall(CODE[chapter]):
        if module:
            assert module != chapter and set(names.split(", ")) <= set(drawings(module))
        else:
            assert names == f"{chapter} as draw"


@pytest.mark.parametrize("module", MODULES)
def test_every_drawing_says_draw_has_hints_and_is_in_a_chapter(module):
    for name, function in drawings(module).items():
        assert function.__doc__.startswith("Draw "), name
        parameters = inspect.signature(function).parameters
        assert {*parameters, "return"} == set(function.__annotations__), name
        assert any(re.search(rf"\b{name}\(", code) for code in CODE.values()), name


PLAIN = (1.0, 1, True, "x", None, (), {}, np.ones(1))  # one of them is right for most arguments
WRONG = (object(), [object()], {object(): object()}, b"1")  # none of them is right for any


def right(hint):
    """Return what the check of a hint takes; of a record, one without fields."""
    for value in PLAIN:
        try:
            _hints._check(hint)("argument", value)
        except ValueError:
            continue
        return value
    parts = get_args(hint)
    return tuple(map(right, parts)) if parts else object.__new__(hint)


@pytest.mark.parametrize("module", MODULES)
def test_every_drawing_names_the_argument_that_is_of_a_wrong_kind(module):
    for drawing, function in drawings(module).items():
        hints = get_type_hints(function, include_extras=True)
        hints.pop("return")
        valid = {name: right(hint) for name, hint in hints.items()}
        for name, hint in hints.items():
            wrong = list(WRONG)
            if get_origin(hint) is dict:
                wrong.append({right(get_args(hint)[0]): object()})
            for value in wrong:
                with pytest.raises(ValueError, match=rf"^{name}\b.* must ") as told:
                    function(**valid | {name: value})
                assert " got " in str(told.value), drawing
