"""What a package gives is loaded when it is first asked for (PEP 562), or says what is missing."""

from functools import cache
from importlib import import_module


def attach(package, path, home=()):
    """Return the `__getattr__` and `__dir__` of a package that loads its modules by itself.

    package: Its `__name__`.
    path: Its `__path__`. Every module there without a leading underscore is an attribute.
    home: In which module of the package a name of its own stands.
    """

    @cache
    def modules():
        from pkgutil import iter_modules  # here: it takes as long as all the rest

        return sorted(m.name for m in iter_modules(path) if not m.name.startswith("_"))

    def __getattr__(name):
        if name in home:
            return getattr(import_module(f"{package}.{home[name]}"), name)
        if not name.startswith("_") and name in modules():
            return import_module(f"{package}.{name}")
        raise AttributeError(f"module {package!r} has no attribute {name!r}")

    def __dir__():
        return sorted({*home, *modules()})

    return __getattr__, __dir__


def by_name(modules):
    """Return {name: module} of {module: names, with spaces between them}, for `attach`."""
    return {name: module for module, names in modules.items() for name in names.split()}


def require(library, extra):
    """Raise unless a library that an extra of this one brings is installed.

    Raises ModuleNotFoundError with the command that installs it.
    """
    try:
        import_module(library)
    except ModuleNotFoundError as error:
        if error.name != library:
            raise
        raise ModuleNotFoundError(
            f'{library} is needed here and not installed: pip install "dopplerlib[{extra}]"',
            name=library,
        ) from None
