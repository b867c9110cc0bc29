"""Functions of the caller, one for all samples or one for each, with checked values."""

from .. import _checks


def callables(name, functions):
    """Return a function, or a tuple of functions, or raise."""
    if isinstance(functions, (list, tuple)):
        return tuple(_checks.function(name, function) for function in functions)
    return _checks.function(name, functions)


def each(name, functions, samples, form):
    """Return for each sample a function whose values are checked: finite, and of `form`.

    `form` is the shape of the runs and that of one value. The functions get a copy, so that they
    cannot change an estimate.
    """
    if not isinstance(functions, (list, tuple)):
        functions = (_checks.function(name, functions),) * samples
    if len(functions) != samples or not all(map(callable, functions)):
        raise ValueError(
            f"{name} must be a function, or {samples} of them, one for each sample, got "
            f"{len(functions)} objects"
        )
    runs, shape = form

    def checked(function):
        def value(x):
            result = _checks.finite(f"{name}(x)", _checks.called(name, function, x.copy()), shape)
            return _checks.each_run(f"{name}(x)", result, runs, shape)

        return value

    return tuple(map(checked, functions))
