"""The interacting multiple model estimator for samples that come one by one."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .. import _checks
from .._typing import ArrayLike
from ._imm_cycle import cycle
from .imm import _logarithms, _models, _rules, _start, _state
from .imm_records import ImmModel, ImmState


@_checks.quiet
def imm_online(
    models: Iterable[ImmModel],
    transition: ArrayLike,
    x0: Any,
    P0: Any,
    mode0: ArrayLike | None = None,
) -> Callable[[ArrayLike], ImmState]:
    """Prepare the estimator of `imm` for samples that come one by one.

    Parameters
    ----------
    models : iterable of ImmModel
        Linear or not; all have the same measurements, and their matrices are those of every sample.
    transition : array_like, shape (M, M)
        Probability to go from the model of the row to the model of the column in one step.
    x0 : array_like, shape (n,), or sequence of them
        State one step before the first measurement, see `imm`.
    P0 : array_like, shape (n, n), or sequence of them
        Its covariance.
    mode0 : array_like, shape (M,), optional
        Probabilities of the models one step before the first measurement; equal if None.

    Returns
    -------
    callable
        A function that takes the next measurement (m,), NaN for a missing component, and returns
        the `ImmState` after it. It remembers the samples before. `imm_step` does the same from a
        state that is handed to it, with other models and probabilities at every step, and checks
        them every time.

    Raises
    ------
    ValueError
        As `imm`; the function too. Such a sample changes nothing.

    Notes
    -----
    Blom and Bar-Shalom (1988); see `imm`. The cycle is the same code as for whole records.

    Examples
    --------
    >>> models = [ImmModel([[1.0]], [[q]], [[1.0]], [[1.0]]) for q in (0.0, 25.0)]
    >>> update = imm_online(models, [[0.95, 0.05], [0.05, 0.95]], [0.0], [[1.0]])
    >>> [bool(update([z]).mode[1] > 0.5) for z in (0.0, 0.1, 9.0)]
    [False, False, True]
    """
    models = _models(models)
    state = _start(models, x0, P0, mode0, ())
    log_transition = _logarithms(transition, 1, len(models))[0]
    sample = np.full((1, models[0].R.shape[-1]), np.nan)
    rules = _rules(models, sample)  # they read the sample from there

    @_checks.quiet
    def update(z: ArrayLike) -> ImmState:
        """Take the next measurement (m,) and return the state after it."""
        nonlocal state
        sample[0] = _checks.exact_shape("z", _checks.measured("z", z, None), sample.shape[1:])
        after = cycle(0, state, models, rules, log_transition)
        found = _state(models, after)
        _checks.estimates("models, x0, P0, z", found.x, found.P, found.mode)
        state = after
        return found

    return update
