"""Measurement errors with a memory: a first-order Gauss-Markov error as part of the state.

A filter takes the errors of its measurements for white. Where they are not, the state grows by one
error for each component of the measurement, which decays with a time constant of its own, and what
remains is white. Both functions return the arguments of a filter, in its order.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .. import _checks
from .._typing import ArrayLike, FloatArray
from ._functions import callables

Function = Callable[..., Any] | Sequence[Callable[..., Any]]
Matrices = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]


@_checks.quiet
def augment_linear(
    F: ArrayLike,
    Q: ArrayLike,
    H: ArrayLike,
    R: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
    *,
    sigma: ArrayLike,
    tau: ArrayLike,
    T: ArrayLike,
) -> Matrices:
    """Add colored measurement errors to the state of a linear model: arguments of `kf`.

    Parameters
    ----------
    F, Q : array_like, shape (n, n) or (K, n, n)
        Transition matrix and covariance of the process noise, as in `kf`.
    H : array_like, shape (m, n) or (K, m, n)
        Measurement matrix.
    R : array_like, shape (m, m) or (K, m, m)
        Covariance of the white part of the errors.
    x0 : array_like, shape (..., n)
        State one step before the first measurement.
    P0 : array_like, shape (..., n, n)
        Its covariance.
    sigma : array_like, broadcast to (K, m)
        Standard deviation of the colored part: one number, one for each component, or one for each
        sample and component.
    tau : array_like, broadcast to (m,)
        Time constant of the colored part in s: errors t apart have the correlation exp(-t / tau).
    T : array_like, scalar or shape (K,)
        Interval before each sample in s.

    Returns
    -------
    F, Q, H, R, x0, P0 : ndarray
        Of a state of n + m components: the last m are the colored errors in units of `sigma`.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, a matrix is not a covariance (`R` positive
        definite), or `sigma`, `tau` or `T` is not positive.

    Notes
    -----
    Bryson and Johansen (1965); Bar-Shalom, Li, Kirubarajan (2001), Sec 8.2. The errors start with
    the deviation that they keep. In units of `sigma` they move by exp(-T / tau), with process noise
    of variance 1 - exp(-2 T / tau), so that uneven times and missing values need nothing else. An
    AR(1) coefficient rho between samples T apart is a time constant of -T / log(rho).

    Examples
    --------
    A constant, measured twice with the same error of variance 1 and hardly any white noise: the
    second measurement teaches nothing.

    >>> from dopplerlib import kf
    >>> model = augment_linear(
    ...     [[1]], [[0]], [[1]], [[1e-9]], [0], [[1e6]], sigma=1.0, tau=1e9, T=1.0
    ... )
    >>> kf([[2.0], [2.0]], *model).P[:, 0, 0].round(3).tolist()
    [1.0, 1.0]
    """
    x0, P0, R, sigma, keep, stir = _errors(x0, P0, R, sigma, tau, T)
    n, m = x0.shape[-1] - R.shape[-1], R.shape[-1]
    F, H = _checks.finite("F", F, (n, n)), _checks.finite("H", H, (m, n))
    Q = _checks.covariance("Q", Q, n, definite=False)
    for name, value in (("F", F), ("Q", Q), ("H", H)):
        _samples(sigma, keep, **{name: value})
    return _diagonal(F, keep), _diagonal(Q, stir), _beside(H, sigma), R, x0, P0


@_checks.quiet
def augment_functions(
    f: Function,
    F: Function,
    Q: ArrayLike,
    h: Function,
    H: Function,
    R: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
    *,
    sigma: ArrayLike,
    tau: ArrayLike,
    T: ArrayLike,
) -> tuple[Any, ...]:
    """Add colored measurement errors to the state of a nonlinear model: arguments of `ekf_records`.

    Parameters
    ----------
    f, F : callable or sequence of callable
        Motion and its Jacobian, as in `ekf_records`.
    Q : array_like, shape (n, n) or (K, n, n)
        Covariance of the process noise.
    h, H : callable or sequence of callable
        Measurement function and its Jacobian.
    R : array_like, shape (m, m) or (K, m, m)
        Covariance of the white part of the errors.
    x0 : array_like, shape (..., n)
        State one step before the first measurement.
    P0 : array_like, shape (..., n, n)
        Its covariance.
    sigma : array_like, broadcast to (K, m)
        Standard deviation of the colored part, see `augment_linear`.
    tau : array_like, broadcast to (m,)
        Its time constant in s.
    T : array_like, scalar or shape (K,)
        Interval before each sample in s.

    Returns
    -------
    f, F, Q, h, H, R, x0, P0 : callable, tuple of callable, or ndarray
        Of a state of n + m components: the last m are the colored errors in units of `sigma`.

    Raises
    ------
    ValueError
        As `augment_linear`; if a function is none.

    Notes
    -----
    See `augment_linear`. `f` and `h` are what `ukf` takes, too.

    Examples
    --------
    The square of a constant, with errors that decay in three samples:

    >>> from dopplerlib import ekf_records
    >>> model = augment_functions(
    ...     lambda x: x, lambda x: [[1.0]], [[0.0]], lambda x: x**2, lambda x: 2 * x[..., None],
    ...     [[0.01]], [3.0], [[1.0]], sigma=0.3, tau=3.0, T=1.0,
    ... )
    >>> ekf_records([[4.1], [3.9], [4.0]], *model).x[:, 0].round(2).tolist()
    [2.19, 2.17, 2.15]
    """
    x0, P0, R, sigma, keep, stir = _errors(x0, P0, R, sigma, tau, T)
    n = x0.shape[-1] - R.shape[-1]
    Q = _checks.covariance("Q", Q, n, definite=False)
    _samples(sigma, keep, Q=Q)

    def own(name, function, x, shape):
        return _checks.finite(f"{name}(x)", _checks.called(name, function, x[..., :n]), shape)

    def motion(f, a):
        return lambda x: np.concatenate([own("f", f, x, (n,)), a * x[..., n:]], axis=-1)

    def slope(F, a):
        return lambda x: _diagonal(own("F", F, x, (n, n)), a)

    def measured(h, s):
        return lambda x: own("h", h, x, s.shape) + s * x[..., n:]

    def gradient(H, s):
        return lambda x: _beside(own("H", H, x, (len(s), n)), s)

    f, F = _each(motion, "f", f, keep), _each(slope, "F", F, keep)
    h, H = _each(measured, "h", h, sigma), _each(gradient, "H", H, sigma)
    return f, F, _diagonal(Q, stir), h, H, R, x0, P0


def _errors(x0, P0, R, sigma, tau, T):
    """Return the start with errors, R, sigma, and factor and noise variance of errors in a step."""
    x0 = _checks.finite("x0", x0, (None,))
    P0 = _checks.covariance("P0", P0, x0.shape[-1], definite=False)
    R = _checks.real("R", R)
    _checks.check_shape("R", R, (None, None))
    m = R.shape[-1]
    R = _checks.covariance("R", R, m)
    sigma = _per_component("sigma", sigma, m, 2)
    tau = _per_component("tau", tau, m, 1)
    T = _checks.deviation("T", T)
    if T.ndim > 1:
        raise ValueError(f"T must be one number or have shape (K,), got shape {T.shape}")
    exponent = -T[..., None] / tau
    keep, stir = np.exp(exponent), -np.expm1(2 * exponent)
    _samples(sigma, keep, R=R)
    x0 = np.concatenate([x0, np.zeros((*x0.shape[:-1], m))], axis=-1)
    return x0, _diagonal(P0, np.ones(m)), R, sigma, keep, stir


def _per_component(name, value, m, most):
    value = _checks.deviation(name, value)
    shape = np.broadcast_shapes(value.shape, (1,))
    if len(shape) > most or shape[-1] not in (1, m):
        wanted = "(K, m)" if most == 2 else "(m,)"
        raise ValueError(f"{name} must broadcast to {wanted}, m = {m}, got shape {value.shape}")
    return np.broadcast_to(value, (*shape[:-1], m))


def _samples(sigma, keep, **matrix):
    """Raise unless all that has an axis of samples has the same number of them."""
    ((name, value),) = matrix.items()
    if value.ndim > 3:
        raise ValueError(f"{name} must have at most 3 axes, got shape {value.shape}")
    counts = {len(v) for v in (sigma, keep) if v.ndim == 2} | set(value.shape[:-2])
    if len(counts - {1}) > 1:
        raise ValueError(
            f"{name} must have the samples of T and sigma, {sorted(counts)}, "
            f"got shape {value.shape}"
        )


def _diagonal(A, diagonal):
    """Return the matrices A (..., n, n) with a diagonal (..., m) after them."""
    n, m = A.shape[-1], diagonal.shape[-1]
    leading = np.broadcast_shapes(A.shape[:-2], diagonal.shape[:-1])
    whole = np.zeros((*leading, n + m, n + m))
    whole[..., :n, :n] = A
    whole[..., range(n, n + m), range(n, n + m)] = diagonal
    return whole


def _beside(H, sigma):
    """Return the matrices [H, diag(sigma)]."""
    leading = np.broadcast_shapes(H.shape[:-2], sigma.shape[:-1])
    own = sigma[..., None] * np.eye(sigma.shape[-1])
    return np.concatenate([np.broadcast_to(v, (*leading, *v.shape[-2:])) for v in (H, own)], -1)


def _each(wrap, name, functions, values):
    """Return one function, or one for each sample if the functions or the values differ."""
    functions = callables(name, functions)
    if not isinstance(functions, tuple) and values.ndim == 1:
        return wrap(functions, values)
    count = len(functions) if isinstance(functions, tuple) else len(values)
    if not isinstance(functions, tuple):
        functions = (functions,) * count
    if values.ndim == 2 and len(values) not in (1, count):
        raise ValueError(f"{name} must be {len(values)} functions, one a sample, got {count}")
    values = np.broadcast_to(values, (count, values.shape[-1]))
    return tuple(wrap(f, value) for f, value in zip(functions, values, strict=True))
