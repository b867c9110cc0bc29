"""There is one loop over scans, and no module reaches into what is private to another."""

import ast
from pathlib import Path

import pytest

LIBRARY = Path(__file__).resolve().parents[1] / "dopplerlib"

STEPS = {
    "gaussian.predict", "gaussian.update", "gaussian.moved", "gaussian.smooth",
    "kf_predict", "kf_update", "ekf_update", "pda_update", "radial_velocity_update",
}  # fmt: skip
STATE = {"P", "state"}
# Loops other than that of `scan`, and why. The list may only become shorter.
ELSEWHERE = {
    "estimation/recursion.py": "the loop",
    "systems/asheim2015/cartesian_tracker.py": "two radars within a scan",
    "systems/asheim2015/range_tracker.py": "two components of a measurement, as scalars for speed",
    "tracking/multi_target.py": "tracks that begin and end, scans that come from an iterator",
}


def own(node):
    """Yield what stands in a loop, but not in functions that are defined in it."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, (ast.FunctionDef, ast.Lambda)):
            yield child
            yield from own(child)


def names(node, context):
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, context)}


def carries(node):
    """Return whether a statement in a loop makes a state or its covariance from itself."""
    if isinstance(node, ast.Call):
        return ast.unparse(node.func) in STEPS
    if not isinstance(node, (ast.Assign, ast.AugAssign)):
        return False
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    stored = set().union(*(names(target, ast.Store) for target in targets))
    read = names(node.value, ast.Load)
    return bool(stored & STATE and (stored & read or isinstance(node, ast.AugAssign)))


def loops(tree):
    """Return the lines of the loops that carry an estimate; an inner one counts as the outer."""
    kinds = (ast.For, ast.While, ast.ListComp, ast.GeneratorExp)
    found = [n for n in ast.walk(tree) if isinstance(n, kinds) and any(map(carries, own(n)))]
    inner = {part for loop in found for part in own(loop)}
    return [loop.lineno for loop in found if loop not in inner]


def test_the_loop_over_scans_stands_once():
    found = {}
    for path in sorted(LIBRARY.rglob("*.py")):
        lines = loops(ast.parse(path.read_text(encoding="utf-8")))
        if lines:
            found[path.relative_to(LIBRARY).as_posix()] = len(lines)
    assert found == dict.fromkeys(ELSEWHERE, 1)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("for k in range(3):\n    x, P = gaussian.predict(x, P, F, Q)", 1),
        ("for z_k in z:\n    x, P = F @ x, F @ P @ F.T + Q", 1),
        ("while z:\n    state = step(z.pop(), state)", 1),
        ("for k in range(3):\n    P += Q", 1),
        ("for k in range(3):\n    for i in range(2):\n        x, P = _updated(x, P, i)", 1),
        ("y = [kf_update(x, P, z_k, H, R) for z_k in z]", 1),
        ("for k in range(3):\n    def step(x, P):\n        x, P = predict(x, P)", 0),
        ("for k in range(3):\n    P = covariance(k)", 0),
        ("x, P = predict(x, P)", 0),
    ],
)
def test_a_loop_that_carries_an_estimate_is_found(text, count):
    assert len(loops(ast.parse(text))) == count


NAMED_TUPLE = {"_asdict", "_fields", "_make", "_replace"}  # public, so as not to be field names


def private_attributes(tree):
    """Return the private attributes that are taken of anything but self, cls and super()."""
    return [
        ast.unparse(node)
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and node.attr.startswith("_")
        and not node.attr.endswith("__")
        and node.attr not in NAMED_TUPLE
        and ast.unparse(node.value) not in ("self", "cls", "super()")
    ]


def test_private_attributes_are_taken_of_none_but_self():
    """With `private_imports` of test_layers.py: nothing private crosses a module's bounds."""
    found = {
        path.relative_to(LIBRARY).as_posix(): private
        for path in sorted(LIBRARY.rglob("*.py"))
        if (private := private_attributes(ast.parse(path.read_text(encoding="utf-8"))))
    }
    assert found == {"_compile.py": ["dispatcher._cache"]}  # numba has no public way


def test_a_private_attribute_is_found():
    tree = ast.parse("from ..model import a\na._b(self._c, x.__class__)\ndel a.d._e")
    assert sorted(private_attributes(tree)) == ["a._b", "a.d._e"]
