"""The lists of faults must not rot, and the tool must tell a fault that is noticed from another."""

import tomllib

import pytest

from tools import mutants


@pytest.mark.parametrize("name", mutants.names())
def test_every_fault_can_still_be_made(name):
    assert len({one["id"] for one in mutants.mutants(name)}) == len(mutants.mutants(name))
    for one in mutants.mutants(name):
        assert set(one) == {"id", "file", "old", "new", "tests", "says"}, one["id"]
        text = (mutants.ROOT / one["file"]).read_text(encoding="utf-8")
        assert text.count(one["old"]) == 1, one["id"]
        assert one["new"] != one["old"], one["id"]
        for test in one["tests"]:
            assert (mutants.ROOT / test.split("::")[0]).exists(), one["id"]


def test_a_fault_is_killed_by_a_test_that_fails_and_mended_afterwards(tmp_path):
    (tmp_path / "a.py").write_text("def double(x):\n    return 2 * x\n")
    (tmp_path / "test_a.py").write_text(
        "from a import double\n\ndef test_double():\n    assert double(3) == 6\n"
    )
    text = '[[mutant]]\nid = "three"\nfile = "a.py"\nold = "2 * x"\nnew = "%s"\nsays = "s"\n'
    for new, dies in (("3 * x", True), ("x + x", False)):
        one = tomllib.loads(text % new)["mutant"][0] | {"tests": ["test_a.py"]}
        assert mutants.killed(tmp_path, one) is dies
        assert "2 * x" in (tmp_path / "a.py").read_text()
    with pytest.raises(ValueError, match="old of three must occur once"):
        mutants.killed(tmp_path, one | {"old": "4 * x"})
