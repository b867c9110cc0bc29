"""Every public name of the library stands on the reference page, once."""

import ast
import html
import inspect
import re
from importlib import import_module
from pathlib import Path

import pytest

import dopplerlib

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "book" / "api.md").read_text(encoding="utf-8")
# Packages whose modules are shown whole. The others are shown by what dopplerlib gives.
WHOLE = ("systems", "figures", "derive", "kernels")
MODULES = sorted(
    "dopplerlib."
    + path.relative_to(ROOT / "dopplerlib").with_suffix("").as_posix().replace("/", ".")
    for package in WHOLE
    for path in (ROOT / "dopplerlib" / package).rglob("*.py")
    if not path.name.startswith("_")
)


def directives(kind):
    """Return the arguments of all directives of a kind, in the order of the page."""
    return re.findall(rf"^\.\. {kind}:: (\S+)$", PAGE, flags=re.MULTILINE)


def test_every_public_name_is_shown_once_and_nothing_else():
    shown = [
        name for name in directives("autofunction") + directives("autoclass") if "." not in name
    ]
    assert sorted(shown) == dopplerlib.__all__


@pytest.mark.parametrize("name", dopplerlib.__all__)
def test_a_function_is_shown_as_one_and_a_record_as_one(name):
    is_class = inspect.isclass(getattr(dopplerlib, name))
    assert name in directives("autoclass" if is_class else "autofunction")


def test_every_module_for_the_reader_is_shown_whole_once():
    assert sorted(directives("automodule")) == MODULES


def test_every_module_shows_its_members():
    assert len(
        re.findall(r"^\.\. automodule:: \S+\n   :members:$", PAGE, flags=re.MULTILINE)
    ) == len(MODULES)


@pytest.mark.parametrize("name", MODULES)
def test_what_a_module_shows_is_explained(name):
    """Sphinx leaves out, without a word, what has no docstring."""
    tree = ast.parse(Path(import_module(name).__file__).read_text(encoding="utf-8"))
    public = [
        node
        for node in tree.body
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_")
    ]
    assert public
    assert [node.name for node in public if not ast.get_docstring(node)] == []


@pytest.mark.parametrize("name", ["RadarArray", "Scenario"])
def test_what_a_record_can_do_is_shown(name):
    cls = getattr(dopplerlib, name)
    public = [
        member
        for member, value in vars(cls).items()
        if not member.startswith("_") and isinstance(value, (classmethod, property))
    ]
    (members,) = re.findall(rf"autoclass:: {name}\n   :members: (.*)", PAGE)
    assert sorted(members.split(", ")) == sorted(public)


def test_a_result_that_is_not_imported_from_the_top_is_shown_as_well():
    whiteness = dopplerlib.innovation_whiteness([[1.0], [2.0], [0.0]], [[[1.0]]] * 3, lags=1)
    cls = type(whiteness)
    assert f"{cls.__module__}.{cls.__name__}" in directives("autoclass")


def test_the_page_can_be_referred_to():
    assert PAGE.startswith("(sec-api)=\n# ")


def visible_names(page):
    """Return the kind and the visible name of every entry of a built page, in its order."""
    entries = re.findall(r'<dl class="py (\w+)">\s*<dt [^>]*>(.*?)</dt>', page, flags=re.DOTALL)
    found = []
    for kind, signature in entries:
        text = html.unescape(re.sub(r"<[^>]*>", "", signature)).strip()
        name = re.match(r"(?:(?:class|classmethod|exception|static|property) )*([\w.]+)", text)[1]
        found.append((kind, name))
    return found


def test_every_entry_of_the_built_page_can_be_imported_as_it_stands_there(built_book):
    page, owner = (built_book / "api.html").read_text(encoding="utf-8"), None
    entries = visible_names(page)
    assert len(entries) >= len(directives("autofunction") + directives("autoclass")) + len(MODULES)
    for kind, name in entries:
        if kind in ("method", "property", "attribute"):  # below the class that it belongs to
            assert hasattr(owner, name) or name in owner.__dataclass_fields__
            continue
        module, _, last = name.rpartition(".")
        value = getattr(import_module(module), last)
        assert value.__name__ == last
        if kind == "class":
            owner = value


def test_an_entry_without_its_module_cannot():
    page = '<dl class="py function">\n<dt class="sig" id="a.b"><span>b</span>(<em>x</em>)</dt>'
    assert visible_names(page) == [("function", "b")]
    with pytest.raises(ValueError, match="Empty module name"):
        import_module(visible_names(page)[0][1].rpartition(".")[0])
