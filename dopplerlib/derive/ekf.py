"""One cycle of the extended Kalman filter for constant velocity and Doppler measurements.

The covariance is kept as its factors, P = U D U' with U unit upper triangular and D diagonal
(Bierman 1977). A variance is then a sum of squares with positive weights: no rounding makes it
negative, however much better the measurements are than the start. R is diagonal, so the update of
all N sensors is done one sensor at a time: for the *linearized* model this is the same estimate as
the update with the N x N innovation covariance, for any number of sensors and without a matrix
inverse. All Jacobians belong to the predicted state.
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


def _real(*names):
    return [sp.Symbol(name, real=True) for name in names]


def _vector(letter):
    return _real(*(f"{letter}_{axis}" for axis in _AXES))


T = sp.Symbol("T", positive=True)
COVARIANCE = _real(*(f"p_{_AXES[i]}_{_AXES[j]}" for i, j in UPPER))
# The diagonal of U is one, so D takes its place.
FACTORS = _real(*(f"D_{_AXES[i]}" if i == j else f"U_{_AXES[i]}_{_AXES[j]}" for i, j in UPPER))
NOISE = _vector("g")
PROJECTION = _vector("f")
WEIGHTED = _vector("b")
CORRECTION = _vector("c")
NIS, MEASUREMENT, VARIANCE, INNOVATION = _real("nis", "measurement", "variance", "innovation")

# Added to both sides of a fraction that would be 0 / 0 where nothing is uncertain. A double that is
# larger than 1e-284 does not change by it.
NOTHING = sp.Float(1e-300)


def transition():
    """Return F of the constant-velocity model (Eq 4)."""
    eye, zero = sp.eye(3), sp.zeros(3)
    return sp.Matrix(sp.BlockMatrix([[eye, T * eye], [zero, eye]]))


def factors():
    """Return U and D."""
    U, D = sp.eye(6), sp.zeros(6)
    for (i, j), entry in zip(UPPER, FACTORS, strict=True):
        (D if i == j else U)[i, j] = entry
    return U, D


def _new(symbols):
    return _real(*(f"{symbol.name}_new" for symbol in symbols))


def predict_block():
    """Return the time update of Table 1, but for its noise: x = F x, P = F P F'.

    F is unit upper triangular, and so is F U. It is the new U, and D stays as it is.
    """
    F, (U, _) = transition(), factors()
    state = _changed(sp.Matrix(STATE), F @ sp.Matrix(STATE))
    factor = _changed(U, F @ U)
    used = set().union(*(value.free_symbols for _, value in (*state, *factor)))
    return Block(
        name="predict",
        summary="Time update but for its noise: x = F x, U = F U (Table 1). The rest stays.",
        inputs=tuple(symbol for symbol in (*STATE, *FACTORS, T) if symbol in used),
        stages=(Stage("state", state), Stage("factor U", factor)),
        outputs=tuple(name for name, _ in (*state, *factor)),
    )


def _changed(before, after):
    """Return the assignments of the entries that differ."""
    pairs = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    return [(_new([old])[0], new) for old, new in pairs]


def noise_block():
    """Return the rest of the time update of Table 1: P + g g', for one column of G sigma_a (Eq 9).

    From the last axis to the first, each takes its share of the noise and leaves the rest, along
    what is left of g, to the axes before (Agee and Turner 1972). All terms are positive.
    """
    U, D = factors()
    rest, weight = list(NOISE), sp.S.One
    assignments, new = [], {}
    for j in reversed(range(6)):
        axis = _AXES[j]
        share, inverse, gain, left = _real(
            *(f"{name}_{axis}" for name in ("share", "inverse", "gain", "weight"))
        )
        (new[j, j],) = _new([D[j, j]])
        assignments += [(share, weight * rest[j]), (new[j, j], D[j, j] + share * rest[j])]
        if j:
            assignments += [
                (inverse, 1 / (new[j, j] + NOTHING)),
                (gain, share * inverse),
                (left, weight * (D[j, j] + NOTHING) * inverse),
            ]
            weight = left
        for i in range(j):
            (remaining,) = _real(f"g_{_AXES[i]}_{axis}")
            (new[i, j],) = _new([U[i, j]])
            assignments += [
                (remaining, rest[i] - rest[j] * U[i, j]),
                (new[i, j], U[i, j] + gain * remaining),
            ]
            rest[i] = remaining
    return Block(
        name="add_noise",
        summary="Factors of P + g g', the noise of the time update (Table 1, Eq 9).",
        inputs=(*FACTORS, *NOISE),
        stages=(Stage("from the last axis to the first", assignments),),
        outputs=tuple(new[place] for place in UPPER),
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
    """Return f = U' h and b = D f; f of one sensor times b of another is an entry of H P H'."""
    return Block(
        name="project",
        summary="f = U' h and b = D f of one linearized sensor, for H P H' (Table 1).",
        inputs=(*FACTORS, *GRADIENT),
        stages=(projection_stage(),),
        outputs=(*PROJECTION, *WEIGHTED),
    )


def projection_stage():
    """Return the assignments of f = U' h and b = D f."""
    U, D = factors()
    f = U.T @ sp.Matrix(GRADIENT)
    b = D @ sp.Matrix(PROJECTION)
    return Stage(
        "f = U' h, b = D f",
        [*zip(PROJECTION, f, strict=True), *zip(WEIGHTED, b, strict=True)],
    )


def update_block():
    """Return the measurement update of Table 1 by one sensor.

    The innovation and the gradient are those at the predicted state for every sensor; what the
    sensors so far have corrected is kept apart, in `CORRECTION`. A sensor of gradient zero,
    innovation zero and variance one changes nothing, to the last bit: so enters a missing one.
    """
    U, D = factors()
    f, b, h, c = PROJECTION, WEIGHTED, sp.Matrix(GRADIENT), sp.Matrix(CORRECTION)
    a = [VARIANCE, *_vector("a")]
    inverse = _vector("inverse")
    # Row i of P h = U b, summed up as far as column j.
    w = [[b[i]] for i in range(6)]
    factor, new = [], {}
    for j in range(6):
        (new[j, j],) = _new([D[j, j]])
        factor.append((new[j, j], D[j, j] * (a[j] * inverse[j])))
        if j:
            (lost,) = _real(f"lost_{_AXES[j]}")
            factor.append((lost, f[j] * inverse[j - 1]))
        for i in range(j):
            (new[i, j],) = _new([U[i, j]])
            (total,) = _real(f"w_{_AXES[i]}_{_AXES[j]}")
            factor += [
                (new[i, j], U[i, j] - w[i][-1] * lost),
                (total, w[i][-1] + U[i, j] * b[j]),
            ]
            w[i].append(total)
    e, weighted = _real("e", "weighted")
    correct = [
        (e, INNOVATION - h.dot(c)),
        (weighted, e * inverse[-1]),
        *((new_c, c_i + w_i[-1] * weighted) for new_c, c_i, w_i in zip(_new(c), c, w, strict=True)),
        (*_new([NIS]), NIS + e * weighted),
    ]
    return Block(
        name="update",
        summary="Measurement update by one linearized sensor (Table 1, Eq 14).",
        inputs=(*FACTORS, *CORRECTION, NIS, INNOVATION, *GRADIENT, VARIANCE),
        stages=(
            projection_stage(),
            Stage(
                "the variance h' P h + r of the innovation, axis by axis",
                [(a[j + 1], a[j] + f[j] * b[j]) for j in range(6)]
                + [(inverse[j], 1 / a[j + 1]) for j in range(6)],
            ),
            Stage("factors, and P h = U b on the way", factor),
            Stage("innovation e left by the sensors before, correction P h e / a, NIS", correct),
        ),
        outputs=(*(new[place] for place in UPPER), *_new(CORRECTION), *_new([NIS])),
    )


def covariance_block():
    """Return P = U D U'."""
    U, D = factors()
    scaled = {}
    for j in range(6):
        scaled[j, j] = D[j, j]
        for k in range(j + 1, 6):
            (scaled[j, k],) = _real(f"DU_{_AXES[j]}_{_AXES[k]}")
    products = [(name, D[k, k] * U[j, k]) for (j, k), name in scaled.items() if j != k]
    sums = [sum(U[i, k] * scaled[j, k] for k in range(j, 6)) for i, j in UPPER]
    return Block(
        name="covariance",
        summary="P = U D U'.",
        inputs=tuple(FACTORS),
        stages=(Stage("U D", products), Stage("U D U'", list(zip(COVARIANCE, sums, strict=True)))),
        outputs=tuple(COVARIANCE),
    )


def blocks():
    """Return the blocks of one cycle, in the order in which they are used."""
    return (
        predict_block(),
        noise_block(),
        linearize_block(),
        project_block(),
        update_block(),
        covariance_block(),
    )
