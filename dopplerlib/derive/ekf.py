"""One cycle of the extended Kalman filter for constant velocity and Doppler measurements.

The covariance is kept as its 21 distinct entries, so it is symmetric by construction. R is
diagonal, so the update of all N sensors is done one sensor at a time: for the *linearized* model
this is the same estimate as the update with the N x N innovation covariance (Bierman 1977), for
any number of sensors and without a matrix inverse. All Jacobians belong to the predicted state.
"""

import sympy as sp

from .block import Block, Stage
from .doppler import (
    DOPPLER_PER_SPEED,
    GRADIENT,
    SENSOR,
    SHIFT,
    STATE,
    gradient_stage,
    line_of_sight_stage,
)

_AXES = ("x", "y", "z", "vx", "vy", "vz")
UPPER = [(i, j) for i in range(6) for j in range(i, 6)]

T = sp.Symbol("T", positive=True)
COVARIANCE = [sp.Symbol(f"p_{_AXES[i]}_{_AXES[j]}", real=True) for i, j in UPPER]
PROCESS_NOISE = [sp.Symbol(f"q_{_AXES[i]}_{_AXES[j]}", real=True) for i, j in UPPER]
PROJECTION = sp.symbols("u_x u_y u_z u_vx u_vy u_vz", real=True)
CORRECTION = sp.symbols("c_x c_y c_z c_vx c_vy c_vz", real=True)
NIS = sp.Symbol("nis", real=True)
MEASUREMENT, SEEN, VARIANCE = sp.symbols("measurement seen variance", real=True)
INNOVATION = sp.Symbol("innovation", real=True)


def transition():
    """Return F of the constant-velocity model (Eq 4)."""
    eye, zero = sp.eye(3), sp.zeros(3)
    return sp.Matrix(sp.BlockMatrix([[eye, T * eye], [zero, eye]]))


def symmetric(entries):
    """Return the 6 x 6 symmetric matrix whose upper triangle, row by row, is `entries`."""
    matrix = sp.zeros(6)
    for (i, j), entry in zip(UPPER, entries, strict=True):
        matrix[i, j] = matrix[j, i] = entry
    return matrix


def _new(symbols):
    return [sp.Symbol(f"{symbol.name}_new", real=True) for symbol in symbols]


def predict_block():
    """Return the time update of Table 1: x = F x, P = F P F' + Q."""
    f = transition()
    state = list(f @ sp.Matrix(STATE))
    covariance = f @ symmetric(COVARIANCE) @ f.T + symmetric(PROCESS_NOISE)
    # Nested in T (Horner's rule) both off-diagonal entries of a pair share their inner sum.
    covariance = [sp.horner(sp.expand(covariance[i, j]), T) for i, j in UPPER]
    return Block(
        name="predict",
        summary="Time update: x = F x, P = F P F' + Q (Table 1).",
        inputs=(*STATE, *COVARIANCE, *PROCESS_NOISE, T),
        stages=(
            Stage("state", list(zip(_new(STATE), state, strict=True))),
            Stage("covariance", list(zip(_new(COVARIANCE), covariance, strict=True))),
        ),
        outputs=(*_new(STATE), *_new(COVARIANCE)),
    )


def linearize_block():
    """Return what one sensor contributes at the predicted state: its innovation, and h.

    It asks nothing of the covariance. So a processor works on all sensors at once, which the
    update, where each sensor waits for the one before, does not let it do.
    """
    return Block(
        name="linearize",
        summary="Innovation of one sensor at the predicted state, and its gradient (Eqs 6, 7).",
        inputs=(*STATE, MEASUREMENT, *SENSOR, DOPPLER_PER_SPEED),
        stages=(
            line_of_sight_stage(),
            gradient_stage(),
            Stage("innovation", [(INNOVATION, MEASUREMENT - SHIFT)]),
        ),
        outputs=(INNOVATION, *GRADIENT),
    )


def project_block():
    """Return u = P h of one sensor; h of another sensor times it is an entry of H P H'."""
    return Block(
        name="project",
        summary="u = P h of one linearized sensor, for the innovation covariance (Table 1).",
        inputs=(*COVARIANCE, *GRADIENT),
        stages=(projection_stage(),),
        outputs=PROJECTION,
    )


def projection_stage():
    """Return the assignment of u = P h."""
    u = symmetric(COVARIANCE) @ sp.Matrix(GRADIENT)
    return Stage("u = P h", list(zip(PROJECTION, u, strict=True)))


def update_block():
    """Return the measurement update of Table 1 by one sensor.

    The innovation and the gradient are those at the predicted state for every sensor; what the
    sensors so far have corrected is kept apart, in `CORRECTION`. ``seen`` is 1, or 0 for a sensor
    whose measurement is missing: it multiplies the gain.
    """
    p, h, c = symmetric(COVARIANCE), sp.Matrix(GRADIENT), sp.Matrix(CORRECTION)
    u = sp.Matrix(PROJECTION)
    s, e, weight = sp.symbols("s e weight", real=True)
    conditional = Stage(
        "the variance s = h' P h + r, the innovation e left by the sensors before",
        [
            (s, h.dot(u) + VARIANCE),
            (e, INNOVATION - h.dot(c)),
            (weight, SEEN / s),
        ],
    )
    k = u * weight
    gain = sp.symbols("k_x k_y k_z k_vx k_vy k_vz", real=True)
    covariance = p - sp.Matrix(gain) @ u.T
    correct = Stage(
        "gain k, correction, covariance P - k u', NIS",
        [
            *zip(gain, k, strict=True),
            *zip(_new(CORRECTION), c + sp.Matrix(gain) * e, strict=True),
            *zip(_new(COVARIANCE), [covariance[i, j] for i, j in UPPER], strict=True),
            (*_new([NIS]), NIS + e * e * weight),
        ],
    )
    return Block(
        name="update",
        summary="Measurement update by one linearized sensor (Table 1, Eq 14).",
        inputs=(*COVARIANCE, *CORRECTION, NIS, SEEN, INNOVATION, *GRADIENT, VARIANCE),
        stages=(projection_stage(), conditional, correct),
        outputs=(*_new(COVARIANCE), *_new(CORRECTION), *_new([NIS])),
    )
