"""Many small cases in one test: it fails with all that fail, each with its name."""

import pytest


def each(cases, check):
    """Check every case, a tuple of arguments; pytest takes longer for a test than most of them."""
    failed = []
    for case in cases:
        try:
            check(*case)
        except (Exception, pytest.fail.Exception) as error:
            error.add_note(f"case: {case!r}")
            failed.append(error)
    if failed:
        raise BaseExceptionGroup(f"{len(failed)} cases", failed)
