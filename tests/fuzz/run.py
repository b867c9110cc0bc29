"""Try many odd calls of one target with Hypothesis, and shrink what is found."""

import contextlib
import random
import re
import resource
from collections import Counter
from dataclasses import dataclass

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from . import valid_files
from .oddities import odd_calls
from .oracle import Bad, baseline, judge

MEMORY = 4 * 2**30  # bytes of address space that odd calls may use beside what is in use
MOST_SHRUNK = 4
BATCH = 10  # odd calls drawn together, at most: Hypothesis takes longer to begin than to draw
OPTIONS = settings(
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate, Phase.shrink],
)


@dataclass(frozen=True)
class Outcome:
    """What came of the calls of one target: how many were refused, taken and bad, and examples."""

    counts: Counter
    bad: tuple  # of str, one for each kind


def fuzz(target, examples, seed=None):
    """Return the Outcome of the simplest odd call and of `examples` random ones, or a few more.

    They are the same each time if `seed` is None.
    """
    if not target.parameters:
        return Outcome(Counter(), ())
    calls = target.calls
    if not any(calls):
        lacks = "Its docstring holds no Examples that call it."
        return Outcome(Counter(), (f"{target.name}\n  {lacks}",) if not calls else ())
    for call in calls:
        if call.keys() != {"rng"}:  # nothing but a generator is taken for one
            baseline(target, call)
    counts, kinds = Counter(), {}
    strategy = odd_calls(calls)
    batches = -(-examples // BATCH)

    @settings(OPTIONS, max_examples=1 + batches, derandomize=seed is None)
    @given(st.tuples(*[strategy] * -(-examples // batches)))
    def try_all(batch):
        # Hypothesis begins with the simplest batch, the same call again and again: once will do.
        for drawn in batch if counts else batch[:1]:
            kind, text = _try(target, drawn)
            counts["bad" if text else kind] += 1
            if text:
                kinds[kind] = min(kinds.get(kind, text), text, key=len)

    if seed is not None:
        try_all = hypothesis.seed(seed)(try_all)
    with bounded_memory(), contextlib.chdir(valid_files.folder()):
        try_all()
        for kind in list(kinds)[:MOST_SHRUNK]:
            kinds[kind] = _shrunk(target, strategy, kind) or kinds[kind]
    return Outcome(counts, tuple(kinds.values()))


def _try(target, drawn):
    """Return ("refused" or "taken", None), or (kind of fault, text)."""
    try:
        return judge(target, target.calls[drawn[0]], drawn[1]), None
    except Bad as fault:
        return _kind(drawn[1], fault), str(fault)


def _kind(odd, fault):
    """Return what two faults share if they are one: the arguments, and where it arose."""
    cause = fault.__cause__
    place = cause and cause.__traceback__
    while place and place.tb_next:
        place = place.tb_next
    where = (place.tb_frame.f_code.co_filename, place.tb_lineno) if place else None
    if not where or where[0].endswith("_checks.py"):
        where = re.sub(r"got .*|[\d.e+-]+", "", str(fault).split("\n")[1])
    return (*sorted(odd), type(cause).__name__, where)


def _shrunk(target, strategy, kind):
    """Return the text of the simplest call that shows the same kind of fault."""
    with contextlib.suppress(hypothesis.errors.NoSuchExample):
        found = hypothesis.find(
            strategy,
            lambda drawn: _try(target, drawn)[0] == kind,
            settings=settings(OPTIONS, max_examples=500),
            random=random.Random(1),
        )
        return _try(target, found)[1]


@contextlib.contextmanager
def bounded_memory():
    """Let no odd size take the machine's memory: it becomes a MemoryError, which is bad."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
