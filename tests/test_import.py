"""Importing the library is cheap, and every public name is there and explained."""

import inspect
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import dopplerlib

ROOT = Path(__file__).resolve().parents[1]
HEAVY = ("sympy", "matplotlib", "numba", "scipy")
CLASSES = sorted(name for name in dopplerlib.__all__ if inspect.isclass(getattr(dopplerlib, name)))
PACKAGES = sorted(
    ".".join(("dopplerlib", *path.parent.relative_to(ROOT / "dopplerlib").parts))
    for path in (ROOT / "dopplerlib").rglob("__init__.py")
)
FUNCTIONS = sorted(set(dopplerlib.__all__) - set(CLASSES))


def loaded_after(code):
    """Return which heavy libraries a fresh interpreter has loaded after running `code`."""
    code = f"import sys\n{code}\nprint(*sorted({set(HEAVY)!r} & set(sys.modules)))"
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return result.stdout.split()


def test_importing_the_library_loads_nothing_heavy():
    assert loaded_after("import dopplerlib") == []


def test_simulating_loads_nothing_heavy():
    code = """
import numpy
from dopplerlib import RadarArray, doppler_jacobian, doppler_shift, constant_velocity, simulate
from dopplerlib import Scenario, Track
doppler_jacobian([1, 0, 0, 0, 0, 1], RadarArray.ring(6, 0.2))
scenario = Scenario.from_toml("data/mittermaier2016/scenario.toml")
simulate(scenario, 1, rng=numpy.random.default_rng(1))
"""
    assert loaded_after(code) == []


def test_the_probe_does_see_what_is_loaded():
    assert loaded_after("import scipy.stats") == ["scipy"]
    assert "numba" in loaded_after("import dopplerlib.estimation._ekf_loop")


def test_importing_any_module_reads_no_file_but_modules():
    code = f"""
import pkgutil, sys
from importlib import import_module
opened = set()
sys.addaudithook(lambda event, args: event == "open" and opened.add(str(args[0])))
open({str(ROOT / "README.md")!r}).close()
import dopplerlib
for module in pkgutil.walk_packages(dopplerlib.__path__, "dopplerlib."):
    if not module.name.endswith("__main__"):
        import_module(module.name)
print(*sorted(opened), sep="\\n")
"""
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    opened = {Path(line) for line in result.stdout.splitlines() if line.startswith(str(ROOT))}
    ours = {
        path.relative_to(ROOT)
        for path in opened
        if path.suffix not in (".py", ".pyc")
        and path.is_file()
        and not path.relative_to(ROOT).parts[0].startswith(".venv")
    }
    assert ours == {Path("README.md")}


@pytest.mark.parametrize("name", dopplerlib.__all__)
def test_every_public_name_is_there(name):
    value = getattr(dopplerlib, name)
    assert value.__name__ == name
    home = import_module(f"dopplerlib.{dopplerlib._HOME[name]}")
    assert getattr(home, name) is value
    assert value.__module__ == home.__name__ or name in home.__all__
    assert getattr(dopplerlib, name) is value


@pytest.mark.parametrize("name", PACKAGES)
def test_every_module_is_an_attribute_of_its_package_from_the_start(name):
    package = import_module(name)
    there = {
        path.stem if path.is_file() else path.name
        for path in Path(package.__file__).parent.iterdir()
        if path.suffix == ".py" or (path / "__init__.py").is_file()
    }
    public = {module for module in there if not module.startswith("_")}
    assert there and public <= set(dir(package))
    for module in public:  # asked so, it does not matter what has been imported before
        assert package.__getattr__(module) is import_module(f"{name}.{module}")
    for module in ("_lazy", "nothing"):
        with pytest.raises(AttributeError, match=f"module '{name}' has no attribute '{module}'"):
            package.__getattr__(module)


def test_a_package_is_there_whatever_ran_before():
    code = "import dopplerlib; dopplerlib.evaluation.consistency.nees; dopplerlib.signal"
    assert loaded_after(code) == []


def test_what_is_not_installed_is_named_with_the_command_that_installs_it(monkeypatch):
    for library, package, extra in [
        ("matplotlib", "figures", "figures"),
        ("sympy", "derive", "derive"),
    ]:
        monkeypatch.setitem(sys.modules, library, None)
        monkeypatch.delitem(sys.modules, f"dopplerlib.{package}", raising=False)
        with pytest.raises(ModuleNotFoundError, match=library) as told:
            import_module(f"dopplerlib.{package}")
        assert told.value.name == library
        assert f'pip install "dopplerlib[{extra}]"' in str(told.value)


def test_the_names_are_listed_in_order_and_without_repetition():
    assert dopplerlib.__all__ == sorted(set(dopplerlib.__all__))
    packages = {name.split(".")[1] for name in PACKAGES if "." in name}
    assert dir(dopplerlib) == sorted({*dopplerlib.__all__, *packages})


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'dopplerlib' has no attribute 'kalman'"):
        dopplerlib.kalman  # noqa: B018
    with pytest.raises(ImportError, match="kalman"):
        from dopplerlib import kalman  # noqa: F401
    assert not hasattr(dopplerlib, "_HOUSE")


def sections(value):
    """Return {title: lines} of a numpydoc docstring."""
    doc = inspect.getdoc(value)
    parts = re.split(r"^(\w[\w ]*)\n-+\n", doc, flags=re.MULTILINE)
    for title in parts[1::2]:
        assert f"{title}\n{'-' * len(title)}\n" in doc, f"{title} is underlined at another length"
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def entries(text):
    """Return {name: type} of the entries of a section; ``F, Q : type`` counts as two."""
    found = re.findall(r"^(\w+(?:, \w+)*) : (.+)$", text, flags=re.MULTILINE)
    return {name: kind for names, kind in found for name in names.split(", ")}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_explains_each_argument_its_result_and_its_source(name):
    function = getattr(dopplerlib, name)
    doc = sections(function)
    missing = {"Parameters", "Returns", "Notes"} - doc.keys()
    assert not missing, f"sections that the docstring of {name} lacks (its source stands in Notes)"
    assert list(entries(doc["Parameters"])) == list(inspect.signature(function).parameters)


@pytest.mark.parametrize("name", CLASSES)
def test_every_record_explains_each_field(name):
    cls = getattr(dopplerlib, name)
    doc = sections(cls)
    fields = entries(doc.get("Parameters") or doc["Attributes"])
    assert list(fields) == list(cls.__dataclass_fields__)


@pytest.mark.parametrize("name", dopplerlib.__all__)
def test_every_array_has_a_shape(name):
    doc = sections(getattr(dopplerlib, name))
    for title in ("Parameters", "Attributes", "Returns"):
        text = doc.get(title, "")
        # A result may stand without a name.
        kinds = [*entries(text).values(), *re.findall(r"^ndarray.*$", text, flags=re.MULTILINE)]
        for kind in kinds:
            if "array" in kind and "RadarArray" not in kind:
                assert re.search(r"shape \(|broadcast to \(", kind), f"{title}: {kind}"


@pytest.mark.parametrize("name", [*FUNCTIONS, "RadarArray", "Scenario"])
def test_every_function_says_when_it_raises_and_gives_an_example(name):
    doc = sections(getattr(dopplerlib, name))
    assert "Raises" in doc
    assert ">>>" in doc.get("Examples", ""), "make test runs the examples"
