"""Every public name of the library stands in the reference, once, and can be imported as shown."""

import ast
import html
import os
import re
import sys
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest

import dopplerlib

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "book" / "reference"
LONGEST_PAGE = 200_000  # bytes of HTML: what is longer is not found by eye
# Packages that the book shows in its chapters, and as source.
SOURCE_ONLY = ("systems", "figures")

sys.path.insert(0, str(ROOT / "book" / "_ext"))
reference = import_module("reference")
sys.path.remove(str(ROOT / "book" / "_ext"))


def all_modules():
    """Return the public modules of the library, but for those of documents and figures."""
    library = ROOT / "dopplerlib"
    parts = [path.relative_to(library).with_suffix("").parts for path in library.rglob("*.py")]
    return sorted(
        ".".join(["dopplerlib", *names])
        for names in parts
        if names[0] not in SOURCE_ONLY and not any(name.startswith("_") for name in names)
    )


MODULES = all_modules()


def shown_modules(folder=PAGES):
    """Return the modules that the pages of a folder show, each as often as it is shown."""
    named = reference.fences(folder)
    texts = [path.read_text(encoding="utf8") for path in folder.rglob("*.md")]
    found = [fence for text in texts for fence in reference.FENCE.findall(text)]
    return [module for fence in found for module in reference.modules_of(fence, named)]


def entries():
    """Return (path, kind, module) of every entry that the pages are to hold."""
    return [
        (reference.shown_as(module, name), kind, module)
        for module in shown_modules()
        for name, kind in reference.public_names(module)
    ]


def test_every_public_module_is_shown_once():
    assert sorted(shown_modules()) == MODULES


def test_a_page_takes_modules_from_that_of_their_package(tmp_path):
    fence = "```{reference} dopplerlib.tracking%s\n```\n"
    (tmp_path / "all.md").write_text("# A\n\n" + fence % "", encoding="utf8")
    every = shown_modules(tmp_path)
    assert "dopplerlib.tracking.pda" in every
    (tmp_path / "some.md").write_text(fence % " gates pda", encoding="utf8")
    assert sorted(shown_modules(tmp_path)) == every
    assert reference.fences(tmp_path) == {
        "dopplerlib.tracking": ["dopplerlib.tracking.gates", "dopplerlib.tracking.pda"]
    }


def test_every_public_name_is_shown_once():
    shown = [path for path, _, _ in entries()]
    assert sorted(path for path in shown if path.count(".") == 1) == [
        f"dopplerlib.{name}" for name in dopplerlib.__all__
    ]
    assert len(shown) == len(set(shown))


@pytest.mark.parametrize("module", MODULES)
def test_what_a_module_shows_is_explained(module):
    """Sphinx leaves out, without a word, what has no docstring."""
    there = import_module(module)
    assert there.__doc__
    assert [n for n, _ in reference.public_names(module) if not getattr(there, n).__doc__] == []


@pytest.mark.parametrize("package", SOURCE_ONLY)
def test_what_stands_in_the_book_as_source_is_explained(package):
    for path in (ROOT / "dopplerlib" / package).rglob("[!_]*.py"):
        tree = ast.parse(path.read_text(encoding="utf8"))
        public = [n for n in tree.body if isinstance(n, (ast.FunctionDef, ast.ClassDef))]
        assert [n.name for n in public if n.name[0] != "_" and not ast.get_docstring(n)] == [], path


def test_a_new_function_needs_no_edit(tmp_path, monkeypatch):
    module = tmp_path / "dopplernew" / "part.py"
    module.parent.mkdir()
    (module.parent / "__init__.py").touch()
    (module.parent / "_hidden.py").touch()
    module.write_text(
        '"""Parts."""\n\ndef f():\n    """Do it."""\n\nclass Off(ValueError):\n    """Wrong."""\n'
        "\ndef _g(): ...\n",
        encoding="utf8",
    )
    monkeypatch.syspath_prepend(tmp_path)
    assert reference.public_modules("dopplernew") == ["dopplernew.part"]
    text = reference.page(["dopplernew.part"])
    assert ".. autofunction:: dopplernew.part.f\n" in text
    assert ".. autoexception:: dopplernew.part.Off\n" in text
    assert "_g" not in text


def test_the_pages_can_be_referred_to():
    for path in PAGES.glob("*.md"):
        assert re.match(r"\(sec-[\w-]+\)=\n# ", path.read_text(encoding="utf8")), path


def visible_names(page):
    """Return the kind and the visible name of every entry of a built page, in its order."""
    found = []
    for kind, signature in re.findall(
        r'<dl class="py (\w+)">\s*<dt [^>]*>(.*?)</dt>', page, flags=re.DOTALL
    ):
        text = html.unescape(re.sub(r"<[^>]*>", "", signature)).strip()
        name = re.match(r"(?:(?:class|classmethod|exception|static|property) )*([\w.]+)", text)[1]
        found.append((kind, name))
    return found


def test_every_entry_of_the_built_pages_can_be_imported_as_it_stands_there(built_book):
    seen, owner = [], None
    for path in sorted((built_book / "reference").glob("*.html")):
        for kind, name in visible_names(path.read_text(encoding="utf-8")):
            if kind in ("method", "property", "attribute"):  # below the class that it belongs to
                assert hasattr(owner, name) or name in owner.__dataclass_fields__
                continue
            module, _, last = name.rpartition(".")
            value = getattr(import_module(module), last)
            assert value.__name__ == last
            seen.append(name)
            if kind in ("class", "exception"):
                owner = value
    assert sorted(seen) == sorted(path for path, _, _ in entries())


def test_no_built_page_is_too_long(built_book):
    long = {
        path.name: path.stat().st_size
        for path in (built_book / "reference").glob("*.html")
        if path.stat().st_size > LONGEST_PAGE
    }
    assert long == {}, "give some of its modules a page of their own, see algebra.md"


def test_what_no_page_shows_is_in_the_built_book_as_source(built_book):
    assert (built_book / "_modules" / "index.html").exists()
    for package in SOURCE_ONLY:
        for module in reference.public_modules(f"dopplerlib.{package}"):
            assert (built_book / "_modules" / f"{module.replace('.', '/')}.html").exists(), module


def test_an_entry_without_its_module_cannot():
    page = '<dl class="py function">\n<dt class="sig" id="a.b"><span>b</span>(<em>x</em>)</dt>'
    assert visible_names(page) == [("function", "b")]
    with pytest.raises(ValueError, match="Empty module name"):
        import_module(visible_names(page)[0][1].rpartition(".")[0])


def test_a_page_of_source_leads_back_to_the_names_as_the_reference_shows_them():
    """Sphinx would take `dopplerlib`, from which one name of the module is shown, for all."""
    body = '<a class="viewcode-back" href="../../../reference/model.html#dopplerlib.{}">'
    names = ["state_size", "DopplerLinks.shifts", "model.links.DopplerLinks"]
    context = {"body": "".join(body.format(name) for name in names)}
    shown = ["model.links.state_size", "DopplerLinks", "signal._npy.read_npy", "read_npy"]
    objects = {f"dopplerlib.{name}": SimpleNamespace(aliased="._" in name) for name in shown}
    env = SimpleNamespace(get_domain=lambda name: SimpleNamespace(objects=objects))
    app = SimpleNamespace(env=env)
    reference.lead_back(app, "_modules/dopplerlib/model/links", "page.html", context, None)
    assert re.findall(r"#([\w.]+)", context["body"]) == [
        "dopplerlib.model.links.state_size",
        "dopplerlib.DopplerLinks.shifts",
        "dopplerlib.DopplerLinks",
    ]
    context = {"body": body.format("signal._npy.read_npy")}
    reference.lead_back(app, "_modules/dopplerlib/signal/_npy", "page.html", context, None)
    assert "#dopplerlib.read_npy" in context["body"]


def test_pages_of_source_that_are_older_than_the_reference_are_made_again(tmp_path):
    for name in ("reference", "html/_modules"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "reference" / "a.md").touch()
    old, new = (tmp_path / "html" / "_modules" / f"{name}.html" for name in ("old", "new"))
    for page in (old, new):
        page.touch()
    os.utime(old, (0, 0))
    os.utime(new, (4e9, 4e9))
    reference.drop_outdated_sources(SimpleNamespace(srcdir=tmp_path, outdir=tmp_path / "html"))
    assert not old.exists() and new.exists()
