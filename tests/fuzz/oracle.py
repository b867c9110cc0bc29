"""What a call with odd arguments may do: refuse by name, or give a finite result."""

import contextlib
import copy
import dataclasses
import inspect
import math
import re
import signal
import warnings
from pathlib import Path

import numpy as np

from dopplerlib.estimation.initial_estimate import ImplausibleStart

from .documented import refused
from .targets import RESULTS
from .values import Raised

SECONDS = 60  # of processor time, for one call; in the first one numba may compile
# How a docstring says that a result may hold NaN or infinity.
MISSING = re.compile(r"\b(nan|missing|infinit\w*|inf)\b", flags=re.IGNORECASE)


class Bad(AssertionError):
    """A call that did neither; the text says which call, and what it did."""


class Hang(BaseException):
    """A call took longer than it may."""


@contextlib.contextmanager
def limited(seconds=SECONDS):
    """Raise Hang in a call that takes longer."""

    def stop(number, frame):
        raise Hang

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def fresh(call):
    """Return arguments for one call: a generator anew, the others as they are."""
    return {
        name: copy.deepcopy(value) if isinstance(value, np.random.Generator) else value
        for name, value in call.items()
    }


def invoke(target, arguments):
    """Call the target; a record is used as well: compared, hashed, pickled, and read."""
    several, arguments = _spread(target.function, dict(arguments))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ImplausibleStart)  # a documented outcome ("Warns")
        result = target.function(*several, **arguments)
    if dataclasses.is_dataclass(result) and target.record:
        _use(result)
    return result


def _spread(function, arguments):
    """Return what is handed over by place and by name, for functions that take any number."""
    before = []
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is parameter.VAR_KEYWORD and isinstance(arguments.get(name), dict):
            arguments |= arguments.pop(name)
        if parameter.kind is parameter.VAR_POSITIONAL and name in arguments:
            values = arguments.pop(name)
            before = [arguments.pop(one) for one in before]
            return (*before, *(values if isinstance(values, tuple) else (values,))), arguments
        before.append(name)
    return (), arguments


def _use(record):
    assert record == record, "a record must equal itself"
    assert hash(record) == hash(record)
    with np.printoptions(threshold=8, edgeitems=1):  # of its arrays a few entries tell as much
        repr(record)
    for name, value in vars(type(record)).items():
        if isinstance(value, property) and not name.startswith("_"):
            getattr(record, name)


def judge(target, call, odd):
    """Call `target` with the arguments `odd` {name: Odd} in place of those of `call`.

    Returns "refused" or "taken", or raises Bad.
    """
    arguments = fresh(call)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what cannot be cast, say, is odd as well
            for name, each in odd.items():
                arguments[name] = each.make(arguments[name])
    except Raised:
        raise
    except (ValueError, TypeError) as error:  # a record refuses an odd field by itself
        if not any(each.nature == "field" for each in odd.values()):
            return "refused"  # this oddity does not exist for this value
        return _refused(target, call, odd, error)
    except Exception as error:
        if not any(each.nature == "field" for each in odd.values()):
            return "refused"
        raise Bad(_text(target, call, odd, f"{type(error).__name__}: {error}")) from error
    before = {name: _frozen(value) for name, value in arguments.items()}
    try:
        with warnings.catch_warnings(), limited():
            warnings.simplefilter("error")
            result = invoke(target, arguments)
    except (ValueError, TypeError) as error:
        return _refused(target, call, odd, error, arguments)
    except Raised:
        return "refused"
    except Warning as error:
        if re.search(rf"\b{type(error).__name__}\b", target.doc):
            return "taken"  # and said
        raise Bad(_text(target, call, odd, f"{type(error).__name__}: {error}")) from error
    except Hang:
        raise Bad(_text(target, call, odd, f"takes more than {SECONDS} s")) from None
    except Exception as error:
        raise Bad(_text(target, call, odd, f"{type(error).__name__}: {error}")) from error
    for name, value in arguments.items():
        if before[name] is not None and _frozen(value) != before[name]:
            raise Bad(_text(target, call, odd, f"{name} was changed in place"))
    _check_taken(target, call, odd, result)
    return "taken"


def _frozen(value):
    """Return something that tells whether an array was changed."""
    if isinstance(value, np.ndarray) and value.dtype.kind in "iufcb" and type(value) is np.ndarray:
        return value.shape, value.dtype, value.tobytes(), value.flags.writeable
    if isinstance(value, (list, tuple)):
        return repr(value) if len(value) < 50 else None
    return None


def _refused(target, call, odd, error, arguments=()):
    message = str(error)
    if any(each.same for each in odd.values()) and len(odd) == 1 and not target.record:
        raise Bad(_text(target, call, odd, f"not taken: {message}")) from error
    names = [name for name in odd if name != "self"]
    names += _components(odd)
    # What is wrong with a file is told by its name.
    paths = {key: value for key, value in dict(arguments).items() if key in ("path", "paths")}
    names += [Path(value).name for value in paths.values() if isinstance(value, (str, Path))]
    named = any(re.search(rf"\b{re.escape(name)}\b", message) for name in names)
    first = re.match(r"[\"']?([A-Za-z_]\w*)", message)
    known = {*target.kinds, *call, *_fields(call)}
    if named or (first and first[1] in known):
        return "refused"
    raise Bad(_text(target, call, odd, f"{type(error).__name__}: {message}")) from error


def _components(odd):
    """Return the fields that were replaced in records, and in records in them."""
    labels = [each.label for each in odd.values() if each.nature == "field"]
    return [name for label in labels for name in re.findall(r"(?:^|: )\.(\w+)", label)]


def _fields(call):
    """Return the names of the fields of all records in the arguments, in containers and records."""
    values, names = list(call.values()), set()
    for value in values:  # which grow
        if isinstance(value, dict):
            values += value.values()
        elif isinstance(value, (list, tuple)):
            values += value
        elif dataclasses.is_dataclass(value):
            names |= vars(value).keys()
            values += vars(value).values()
    return names


def _check_taken(target, call, odd, result):
    for name, each in odd.items():
        optional = name in target.optional
        if not target.record and refused(target.kind(name), each.nature, optional):
            raise Bad(_text(target, call, odd, f"taken, although {name} is {target.kind(name)}"))
    if not MISSING.search(target.doc) and not target.record:
        if not finite(result) and finite(baseline(target, call)):
            raise Bad(_text(target, call, odd, f"result is not finite: {_short(result)}"))
    if not target.record and len(odd) == 1 and all(each.nature == "same" for each in odd.values()):
        if not same(result, baseline(target, call)):
            raise Bad(_text(target, call, odd, "another result than for the same as an array"))


_BASELINES = {}


def baseline(target, call):
    """Return the result of the valid call: that of the example that made it, if it is known."""
    key = target.name, id(call)
    if key not in _BASELINES:
        result = RESULTS.get(id(call))
        _BASELINES[key] = call, invoke(target, fresh(call)) if result is None else result
    return _BASELINES[key][1]


def finite(result):
    """Return whether no number in a result is NaN or infinite."""
    if dataclasses.is_dataclass(result):
        return all(map(finite, vars(result).values()))
    if isinstance(result, dict):
        return all(map(finite, result.values()))
    if isinstance(result, (list, tuple)):
        return all(map(finite, result))
    if isinstance(result, np.ndarray):
        return result.dtype.kind not in "fc" or bool(np.isfinite(result).all())
    if isinstance(result, (float, complex)):
        return math.isfinite(abs(result))
    if hasattr(result, "free_symbols"):  # an expression or a matrix of SymPy
        return not re.search(r"\b(nan|zoo|oo)\b", str(result))
    return True


def same(a, b):
    """Return whether two results are equal up to rounding: 1e-12 of the largest entry."""
    if dataclasses.is_dataclass(a):
        return type(a) is type(b) and all(
            same(value, vars(b)[name]) for name, value in vars(a).items()
        )
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, str) or hasattr(a, "free_symbols"):
        return a == b
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(same, a, b))
    x, y = np.asarray(a), np.asarray(b)
    if x.shape != y.shape or x.dtype.kind not in "iufc":
        return x.shape == y.shape
    scale = np.abs(y[np.isfinite(y)]).max(initial=0.0)
    return np.allclose(x, y, rtol=0, atol=1e-12 * scale, equal_nan=True)


def _text(target, call, odd, what):
    changed = ", ".join(f"{name} -> {each.label}" for name, each in odd.items())
    return f"{target.name}({changed})\n  {what}\n  valid: {_short(call)}"


def _short(value, most=300):
    text = re.sub(r"\s+", " ", repr(value))
    return text if len(text) <= most else text[:most] + " ..."
