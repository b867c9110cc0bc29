"""What numba compiles is kept where it can be, and compiled anew where it cannot."""

import re
import zipfile
from pathlib import Path

import numba
import pytest
from numba.core.caching import CacheImpl

import dopplerlib
from dopplerlib._compile import cached_njit, fingerprint
from dopplerlib.estimation import imm, smoother

PACKAGE = Path(dopplerlib.__file__).parent
ADD = "def add(a, b):\n    return a + b\n"

pytestmark = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled")


def function(path):
    """Return a function whose source is said to stand at `path`."""
    names = {"__name__": "added"}  # else older versions of numba would pickle what is built in
    exec(compile(ADD, str(path), "exec"), names)
    return names["add"]


def kept(path, value=1):
    """Return how often numba found the compiled function and how often it did not, in one call."""
    compiled = cached_njit(function(path))
    assert compiled(value, 2) == value + 2
    return sum(compiled.stats.cache_hits.values()), sum(compiled.stats.cache_misses.values())


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "module.py"
    path.write_text(ADD, encoding="utf-8")
    return path


def test_only_one_function_of_the_library_asks_numba_to_cache():
    pattern = re.compile(r"cache=True|enable_caching|FunctionCache")
    texts = {path.name: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    asking = {name for name, text in texts.items() if pattern.search(text)}
    assert asking == {"_compile.py"}


def test_what_was_compiled_is_found_again(source):
    assert kept(source) == (0, 1)
    assert kept(source) == (1, 0)


@pytest.mark.parametrize("where", ["gone.py", "archive.zip/module.py", "wheel.whl/module.py"])
def test_a_function_without_a_source_is_compiled_all_the_same(tmp_path, where):
    for _ in range(2):
        assert kept(tmp_path / where) == (0, 1)


@pytest.mark.skipif(
    not any("Zip" in place.__name__ for place in CacheImpl._locator_classes),
    reason="this numba keeps nothing for a zip file",
)
def test_a_function_from_a_zip_file_is_kept_at_home_if_that_can_be(tmp_path, monkeypatch):
    archive = tmp_path / "archive.zip"
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("module.py", ADD)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert [kept(archive / "module.py") for _ in range(2)] == [(0, 1), (1, 0)]
    monkeypatch.setenv("HOME", str(archive))  # no folder can be made below a file
    assert [kept(archive / "module.py") for _ in range(2)] == [(0, 1), (0, 1)]


def test_a_place_that_fails_later_on_is_done_without(source):
    compiled = cached_njit(function(source))
    (source.parent / "__pycache__").rmdir()
    (source.parent / "__pycache__").write_bytes(b"")
    assert compiled(1, 2) == 3


def test_a_file_that_was_cut_short_is_done_without(source):
    kept(source)
    for path in (source.parent / "__pycache__").iterdir():
        path.write_bytes(path.read_bytes()[:20])
    assert kept(source) == (0, 1)
    assert kept(source) == (1, 0)


def test_nothing_is_compiled_where_numba_is_told_not_to(source, monkeypatch):
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 1)
    add = function(source)
    assert cached_njit(add) is add


def test_the_fingerprint_is_that_of_the_modules():
    assert fingerprint(imm) != fingerprint(smoother)
    assert fingerprint(imm, smoother) == fingerprint(imm) + fingerprint(smoother)
