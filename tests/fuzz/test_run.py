"""The fuzz itself: few calls are as many different ones."""

from tests.fuzz import run
from tests.fuzz.targets import discover


def test_few_odd_calls_are_different_ones(monkeypatch):
    seen = []
    monkeypatch.setattr(run, "_try", lambda target, drawn: (seen.append(str(drawn)), None))
    (target,) = (one for one in discover("dopplerlib.signal") if one.name.endswith(".remove_lines"))
    run.fuzz(target, 5)
    # The simplest, and five at random of hundreds.
    assert len(seen) == 6
    assert len(set(seen)) >= 5
