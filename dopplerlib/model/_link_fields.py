"""Fields of `links.DopplerLinks` from arguments in their several forms."""

import numpy as np

from .. import _checks


def increasing(times):
    """Return times (K,), or raise unless they increase."""
    times = _checks.one_row("times", times, _checks.moderate)
    if not (np.diff(times) > 0).all():
        raise ValueError(f"times must increase, got {times.tolist()}")
    return times.copy()


def ends(name, states, times):
    """Return states (N, 6) without times, or (K, N, 6)."""
    states = _checks.moderate(name, states)
    if states.ndim in (1, 2) and states.shape[-1] == 3:
        states = np.concatenate([states, np.zeros(states.shape)], axis=-1)
    states = np.atleast_2d(states)
    K = () if times is None else times.shape
    if states.shape[-1] != 6 or not states.size or states.shape[:-2] not in ((), K):
        over_time = "with times (K, N, 6)" if times is None else f"({K[0]}, N, 6)"
        wanted = f"(N, 3), (N, 6) or {over_time}"
        raise ValueError(f"{name} must have shape {wanted}, got {states.shape}")
    if times is not None and states.ndim == 2:
        states = np.tile(states, (len(times), 1, 1))
        states[..., :3] += times[:, None, None] * states[..., 3:]
    return states


def clock_matrix(clocks, N):
    """Return the matrix (N, C)."""
    if clocks is None:
        return np.zeros((N, 0))
    if isinstance(clocks, str):
        _checks.one_of("clocks", clocks, ("common", "each"))
        return np.ones((N, 1)) if clocks == "common" else np.eye(N)
    matrix = given = _checks.moderate("clocks", clocks)
    if matrix.ndim == 1 and (matrix == np.round(matrix)).all():
        groups, group = np.unique(matrix, return_inverse=True)
        matrix = np.eye(len(groups))[group]
    if matrix.ndim != 2 or len(matrix) != N:
        raise ValueError(
            f"clocks must be {N} whole numbers or have shape ({N}, C), got {given.shape}"
        )
    return matrix.copy()
