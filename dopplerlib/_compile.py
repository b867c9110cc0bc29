"""Compile with numba, and keep what comes out wherever there is a place for it."""

import hashlib
from contextlib import suppress
from pickle import UnpicklingError

from numba import njit
from numba.core.caching import FunctionCache
from numba.core.runtime import rtsys


def cached_njit(function=None, **options):
    """Compile a function when it is first called, once for all processes if that can be.

    numba itself refuses to compile where its cache has no place: a package that cannot be written
    to beside a home that cannot, a package without sources. Here such a function is compiled in
    every process.
    """
    if function is None:
        return lambda function: cached_njit(function, **options)
    dispatcher = njit(nogil=True, error_model="numpy", **options)(function)
    # A plain function, with NUMBA_DISABLE_JIT, has nothing to keep.
    if dispatcher is not function:
        # No place, or no source: as a file (OSError) or in the zip file (KeyError, ValueError).
        with suppress(RuntimeError, OSError, KeyError, ValueError):
            dispatcher._cache = _Cache(function)
    return dispatcher


def inner_njit(function=None, **options):
    """Compile a function for callers that are compiled, too: Python itself cannot call it.

    Without the wrappers for Python it takes a third less time to compile and to load.
    """
    if function is None:
        return lambda function: inner_njit(function, **options)
    options = {"nogil": True, "error_model": "numpy"} | options
    return njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)(function)


def fingerprint(*modules):
    """Return what changes with the text, or the byte code, of any of these modules.

    numba's cache watches the file of the compiled function only, and the variables of an enclosing
    function: as one of them, the fingerprint of what is compiled in makes a change there a new
    function.
    """
    # The loader knows where a module comes from; it need not be a file.
    parts = (m.__spec__.loader.get_data(m.__spec__.origin) for m in modules)
    return "".join(hashlib.sha256(part).hexdigest() for part in parts)


class _Cache(FunctionCache):
    """numba's cache, for which a place that fails later on is no error either.

    Before it loads anything, numba fills the tables by which it compiles, and imports SciPy for
    them: that takes four times as long as to load this library's functions, which need only the
    counting of references. Who compiles fills the tables then.
    """

    def load_overload(self, sig, target_context):
        with suppress(OSError):
            try:
                rtsys.initialize(target_context)
                return self._load_overload(sig, target_context)
            except (EOFError, UnpicklingError):  # a file was cut short
                self.flush()

    def save_overload(self, sig, data):
        with suppress(OSError):
            super().save_overload(sig, data)
