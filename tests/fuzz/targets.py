"""Public functions, constructors, methods and properties of the library, and valid calls of them.

Nothing is listed by hand. What is public follows from names; what an argument is follows from its
entry in the docstring or from its hint; a valid call is one that the Examples in docstrings make.
So a new function is tested from its first day, and one that no example calls is found.
"""

import contextlib
import copy
import dataclasses
import doctest
import functools
import inspect
import pkgutil
import re
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from . import valid_files

SECTION = re.compile(r"^(\w[\w ]*)\n-+\n", flags=re.MULTILINE)
ENTRY = re.compile(r"^(\*{0,2}\w+(?:, \w+)*) : (.+)$", flags=re.MULTILINE)
PACKAGES = (
    "model", "signal", "estimation", "tracking", "chain", "evaluation", "workspace",
    "replication", "derive",
    "systems.asheim2015", "systems.macaveiu2013", "systems.mittermaier2016",
    "systems.sombatsatien", "systems.valarmathi",
)  # fmt: skip
MOST = 3  # calls of a function that are kept
RESULTS = {}  # what the kept calls gave, by their id: they need not be made again
# How a docstring says that arguments are checked elsewhere: such a function promises nothing.
UNCHECKED = re.compile(r"\bunchecked\b|\bnot checked\b|nothing is checked", flags=re.IGNORECASE)


@dataclass(frozen=True)
class Target:
    """A function to be called, and how: what its arguments are, and valid ones."""

    name: str
    function: object
    kinds: dict  # {argument: type as its docstring gives it}
    doc: str
    optional: frozenset  # arguments that may be None because that is their default
    owner: type | None  # the class whose method or property it is

    @property
    def record(self):
        return inspect.isclass(self.function)

    @property
    def calls(self):
        """Valid calls, as {argument: value}."""
        package = next(name for name in PACKAGES if self.name.startswith(f"{name}."))
        traced = trace(f"dopplerlib.{package}")
        if self.owner and not traced.get(_key(self.function)) and len(self.parameters) == 1:
            made = traced.get(_key(self.owner), [])  # of a property, any record is a call
            return [{"self": self.owner(**call)} for call in made]
        needed = {name for name, each in self.parameters.items() if each.default is each.empty}
        if needed == {"rng"}:  # known without an example, which would take as long as the function
            return traced.get(_key(self.function), [{"rng": np.random.default_rng(1)}])
        return traced.get(_key(self.function), [])

    @property
    def parameters(self):
        return inspect.signature(self.function).parameters

    def kind(self, argument):
        """Return the type of an argument as it is documented, or as it is."""
        return self.kinds.get(argument) or _kind(self.calls[0].get(argument))


@functools.cache
def modules(package, private=False):
    """Return the public modules under `package`, imported; the others as well if `private`."""
    top = import_module(package)
    names = [package]
    if hasattr(top, "__path__"):
        names += [found.name for found in pkgutil.walk_packages(top.__path__, f"{package}.")]
    return [import_module(name) for name in names if private or "._" not in name]


def public(module):
    """Yield (name, object) of what a module offers: what stands in it or is in its ``__all__``."""
    for name, value in vars(module).items():
        home = getattr(value, "__module__", None) or ""
        offered = "._" in home and name in vars(module).get("__all__", ())
        if callable(value) and (home == module.__name__ or offered) and not name.startswith("_"):
            yield name, value


def sections(value):
    """Return {title: text} of a numpydoc docstring."""
    parts = SECTION.split(inspect.getdoc(value) or "")
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def kinds(value):
    """Return {argument: type} from the docstring (``F, Q : type`` counts as two) or the hints."""
    doc = sections(value)
    text = doc.get("Parameters", "") + "\n" + doc.get("Attributes", "")
    found = {
        name.lstrip("*"): kind for names, kind in ENTRY.findall(text) for name in names.split(", ")
    }
    if found or UNCHECKED.search(inspect.getdoc(value) or ""):
        return found
    hints = get_type_hints(inspect.unwrap(value))
    return {name: _documented(hint) for name, hint in hints.items() if name != "return"}


def _documented(hint):
    """Return how a docstring would name the type that a hint stands for."""
    kind, parts = get_origin(hint) or hint, get_args(hint)
    if kind in (Union, UnionType):
        if np.ndarray in parts or {*get_args(ArrayLike)} <= {*parts}:
            return "array_like or others"
        named = " or ".join(_documented(part) for part in parts if part is not NoneType)
        return named + ", optional" * (NoneType in parts)
    if kind is Literal:  # a number among several may be followed by another one of them
        return "{...}" if isinstance(get_args(hint)[0], str) else "int"
    if kind is np.ndarray:
        text = str(hint)
        return "array_like" + " of bool" * ("bool" in text) + " of complex" * ("complex" in text)
    if kind is np.random.Generator:
        return "numpy.random.Generator"
    if kind is Callable:
        return "callable"
    name = getattr(kind, "__name__", str(kind))
    # What a name in capitals refuses, any iterable may be.
    return name.lower() if kind is Any or kind.__module__ == "collections.abc" else name


def members(cls):
    """Yield (name, function) of a record's own public methods and properties."""
    for name, value in vars(cls).items():
        if name.startswith("_"):
            continue
        if isinstance(value, property):
            yield name, value.fget
        elif inspect.isfunction(value):
            yield name, value
        elif isinstance(value, classmethod):
            yield name, getattr(cls, name)


def discover(package):
    """Return the targets of a package, in the order of their names."""
    found = {}
    for module in modules(package):
        if UNCHECKED.search(module.__doc__ or ""):
            continue
        for name, value in public(module):
            if UNCHECKED.search(inspect.getdoc(value) or "") or _is_error(value):
                continue
            path = f"{module.__name__.partition('.')[2]}.{name}"
            found[path] = value, None
            if inspect.isclass(value):
                found |= {f"{path}.{member}": (f, value) for member, f in members(value)}
    return [_target(name, *each) for name, each in sorted(found.items())]


def _is_error(value):
    return inspect.isclass(value) and issubclass(value, BaseException)


def _target(name, function, owner):
    parameters = inspect.signature(function).parameters
    optional = frozenset(key for key, each in parameters.items() if each.default is None)
    return Target(name, function, kinds(function), inspect.getdoc(function) or "", optional, owner)


def _kind(value):
    """Return the type of an argument that its docstring leaves to another function's."""
    if isinstance(value, str):
        return "str"
    if inspect.isfunction(value):
        return "callable"
    if isinstance(value, (int, float, complex, np.number)):
        return "float" if not isinstance(value, int) else "int"
    if isinstance(value, np.ndarray):
        return "array_like of complex" if value.dtype.kind == "c" else "array_like"
    return type(value).__name__


def _key(function):
    return getattr(function, "__qualname__", None), getattr(function, "__module__", None)


@functools.cache
def trace(package):
    """Return {(name, module): calls} that the Examples in `package` make, the shortest first.

    Of functions of the package: their names are wrapped while the examples run. Constructors are
    wrapped in their class, so that records that a function makes are caught as well. What a test
    before has left in a cache would not be made again.
    """
    calls = {}
    with contextlib.ExitStack() as stack:
        for module in _all_modules():
            for value in vars(module).values():
                if inspect.isfunction(getattr(value, "__wrapped__", None)):
                    getattr(value, "cache_clear", lambda: None)()
        for module in modules(package):
            for name, value in public(module):
                if inspect.isclass(value):
                    _wrap_class(value, calls, stack)
                elif inspect.isfunction(value):
                    _replace(module, name, _recorder(value, calls), stack)
        for module in modules(package, private=True):
            for test in doctest.DocTestFinder().find(module):
                if test.examples:
                    test.globs = dict(test.globs)
                    runner = doctest.DocTestRunner(verbose=False)
                    # The names stay: functions that an example defines need them when called again.
                    runner.run(test, out=lambda text: None, clear_globs=False)
        for function, call in valid_files.calls().items():
            if function.__module__.startswith(package):
                _keep(calls, _key(function), call)
                function(**call)
    return {key: [call for _, call in found] for key, found in calls.items()}


def example_calls(package, function):
    """Return the calls of a function that the examples in `package` make, the shortest first."""
    return trace(package).get(_key(function), [])


def _all_modules():
    return [module for name in (*PACKAGES, "systems") for module in modules(f"dopplerlib.{name}")]


def _wrap_class(cls, calls, stack):
    if dataclasses.is_dataclass(cls):
        _replace(cls, "__init__", _recorder(cls.__init__, calls, key=_key(cls), drop=1), stack)
    for name, value in list(vars(cls).items()):
        if name.startswith("_"):
            continue
        if isinstance(value, property):
            _replace(cls, name, property(_recorder(value.fget, calls)), stack)
        elif inspect.isfunction(value):
            _replace(cls, name, _recorder(value, calls), stack)
        elif isinstance(value, classmethod):
            wrapped = _recorder(value.__func__, calls, drop=1)
            _replace(cls, name, classmethod(wrapped), stack)


def _replace(owner, name, value, stack):
    stack.callback(setattr, owner, name, vars(owner)[name])
    setattr(owner, name, value)


def _recorder(function, calls, key=None, drop=0):
    """Wrap a function so that its arguments are kept; `drop` leaves out self or cls."""
    key = key or _key(function)
    signature = inspect.signature(function)

    def recording(*args, **kwargs):
        call = dict(list(signature.bind(*args, **kwargs).arguments.items())[drop:])
        found = calls.get(key, ())
        if len(found) == MOST and _length(call) >= found[-1][0]:
            return function(*args, **kwargs)
        call = {name: _kept(value) for name, value in call.items()}
        result = function(*args, **kwargs)
        _keep(calls, key, call, result)
        return result

    recording.__wrapped__ = function
    recording.__module__, recording.__qualname__ = function.__module__, function.__qualname__
    recording.__doc__, recording.__name__ = function.__doc__, function.__name__
    return recording


def _kept(value):
    """Return a copy of an argument as it was when the call was made."""
    if inspect.isfunction(value):
        return getattr(value, "__wrapped__", value)
    return copy.deepcopy(value)


def _keep(calls, key, call, result=None):
    """Add a call to those of a function if it is among the shortest, of equal ones the first."""
    found = calls.setdefault(key, [])
    found.append((_length(call), call))
    found.sort(key=lambda one: one[0])
    for _, dropped in found[MOST:]:
        RESULTS.pop(id(dropped), None)
    del found[MOST:]
    if result is not None and any(call is kept for _, kept in found):
        with contextlib.suppress(
            TypeError, copy.Error
        ):  # an iterator: what it gives is the example's
            RESULTS[id(call)] = copy.deepcopy(result)


def _length(call):
    return sum(map(_size, call.values()))


def _size(value):
    if dataclasses.is_dataclass(value):
        return sum(map(_size, vars(value).values()))
    if isinstance(value, (list, tuple)):
        return sum(map(_size, value))
    return np.size(value)
