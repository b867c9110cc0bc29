"""Records of the interacting multiple model estimator: model, state, track."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .. import _checks
from .._records import record
from . import models, sigma_points
from ._functions import callables, each
from .recursion import Correct, Predict

Function = Callable[..., Any] | Sequence[Callable[..., Any]]  # for all samples, or each


@record
class ImmModel:
    """One model of an IMM estimator: motion, measurement, and the meaning of its state.

    Attributes
    ----------
    F : ndarray, shape (n, n) or (K, n, n), or callable, or None
        Transition matrix; or the Jacobian of `f`, which takes states (..., n) and returns
        (..., n, n); None for sigma points. At uneven times one for each sample, that of the step
        which leads to it; so may be every matrix and every function here.
    Q : ndarray, shape (n, n) or (K, n, n)
        Covariance of the process noise.
    H : ndarray, shape (m, n) or (K, m, n), or callable, or None
        Measurement matrix; or the Jacobian of `h`; None for sigma points.
    R : ndarray, shape (m, m) or (K, m, m)
        Covariance of the measurement noise.
    f : callable or sequence of callable, optional
        Nonlinear motion: takes states (..., n), returns (..., n).
    h : callable or sequence of callable, optional
        Nonlinear measurement: takes states (..., n), returns (..., m).
    wrap : tuple of int
        Components of a nonlinear measurement that are angles in rad.
    to_common : callable, optional
        Takes states (..., n) of this model and returns them in the common meaning (..., c); None if
        the state has that meaning.
    from_common : callable, optional
        Takes states (..., c) of the common meaning and states (..., n) of this model, from which
        comes what the common ones do not tell, such as a turn rate; returns (..., n).

    Raises
    ------
    ValueError
        If a value is not finite or of another shape, a matrix is not a covariance (`Q` may be
        singular), a function is missing or no function, or one of `to_common` and `from_common`
        is given without the other.

    Examples
    --------
    >>> wandering = ImmModel(F=[[1.0]], Q=[[25.0]], H=[[1.0]], R=[[1.0]])
    >>> squared = ImmModel(None, [[0.1]], None, [[1.0]], f=lambda x: x, h=lambda x: x**2)
    """

    F: np.ndarray | Function | None
    Q: np.ndarray
    H: np.ndarray | Function | None
    R: np.ndarray
    f: Function | None = None
    h: Function | None = None
    wrap: tuple[int, ...] = ()
    to_common: Callable[..., Any] | None = None
    from_common: Callable[..., Any] | None = None

    def __post_init__(self):
        """Check the fields."""
        checked = {name: _checks.finite(name, getattr(self, name), (None, None)) for name in "QR"}
        n, m = (value.shape[-1] for value in checked.values())
        checked["Q"] = _checks.covariance("Q", checked["Q"], n, definite=False)
        checked["R"] = _checks.covariance("R", checked["R"], m)
        for function, slope, shape in (("f", "F", (n, n)), ("h", "H", (m, n))):
            value = getattr(self, slope)
            if getattr(self, function) is None:
                checked[slope] = _checks.finite(slope, value, shape)
            else:
                checked[function] = callables(function, getattr(self, function))
                checked[slope] = None if value is None else callables(slope, value)
        for name in ("F", "Q", "H", "R"):
            if getattr(checked[name], "ndim", 2) not in (2, 3):
                raise ValueError(
                    f"{name} must be one matrix, or one for each sample, got an array of shape "
                    f"{checked[name].shape}"
                )
        checked["wrap"] = _checks.components("wrap", self.wrap, m)
        for name, other in (("to_common", "from_common"), ("from_common", "to_common")):
            if getattr(self, other) is not None:
                _checks.function(name, getattr(self, name))
        return checked

    @property
    def n(self) -> int:
        """Length of its state."""
        return self.Q.shape[-1]


@record
class ImmState:
    """Estimates of all models of an IMM at one sample, and their mixture.

    Attributes
    ----------
    x : ndarray, shape (..., c)
        State estimates, the mean over the models, in their common meaning.
    P : ndarray, shape (..., c, c)
        Their covariances, with the spread between the models.
    mode : ndarray, shape (..., M)
        Probability of each model.
    model_x, model_P : tuple of ndarray, shape (..., n) and (..., n, n)
        States and covariances of each model, in its own meaning.
    log_mode : ndarray, shape (..., M)
        Logarithms of the probabilities but for a constant: models too improbable for a float count.
    """

    x: np.ndarray
    P: np.ndarray
    mode: np.ndarray
    model_x: tuple[np.ndarray, ...]
    model_P: tuple[np.ndarray, ...]
    log_mode: np.ndarray


@record
class ImmTrack:
    """Estimates of an IMM over a record, after the updates.

    Attributes
    ----------
    x : ndarray, shape (..., K, c)
        State estimates, the mean over the models, in their common meaning.
    P : ndarray, shape (..., K, c, c)
        Their covariances, with the spread between the models.
    mode : ndarray, shape (..., K, M)
        Probability of each model.
    last : ImmState, optional
        After the last sample, from which `imm_step` goes on; None in a track of other origin.
    """

    x: np.ndarray
    P: np.ndarray
    mode: np.ndarray
    last: ImmState | None = None


def _prepared(name: str, model: ImmModel, z: np.ndarray) -> tuple[Predict, Correct]:
    """Return the functions by which a model predicts and corrects along z (..., K, m).

    See `recursion.cycle`. `name` is that of the model in errors: ValueError if there are not as
    many matrices or functions as samples.
    """
    batch, (K, m), n = z.shape[:-2], z.shape[-2:], model.n
    scale = sigma_points.scaling(n)

    def matrices(letter, shape):
        return _checks.each_sample(f"{name}.{letter}", getattr(model, letter), K, shape)

    def functions(letter, shape, points):
        runs = (*batch, 2 * n + 1) if points else batch
        return each(f"{name}.{letter}", getattr(model, letter), K, (runs, shape))

    Q, R = matrices("Q", (n, n)), matrices("R", (m, m))
    if model.f is None:
        predict = models.linear_motion(matrices("F", (n, n)), Q)
    elif model.F is None:
        predict = models.sampled_motion(functions("f", (n,), True), Q, scale)
    else:
        f, F = functions("f", (n,), False), functions("F", (n, n), False)
        predict = models.extended_motion(f, F, Q)
    if model.h is None:
        correct = models.linear_measurement(z, matrices("H", (m, n)), R)
    elif model.H is None:
        correct = models.sampled_measurement(z, functions("h", (m,), True), R, scale, model.wrap)
    else:
        h, H = functions("h", (m,), False), functions("H", (m, n), False)
        correct = models.extended_measurement(z, h, H, R, model.wrap)
    return predict, correct
