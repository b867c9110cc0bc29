"""How near a target may be to a point: what an alarm compares with a limit."""

import sympy as sp

from .block import Block, Stage
from .doppler import GRADIENT, STATE
from .ekf import FACTORS, PROJECTION, WEIGHTED, projection_stage

POINT = sp.symbols("q_x q_y q_z", real=True)
AWAY = sp.symbols("a_x a_y a_z", real=True)
DIRECTION = sp.symbols("u_x u_y u_z", real=True)
INVERSE = sp.Symbol("inverse", positive=True)
DISTANCE = sp.Symbol("distance", positive=True)
DISTANCE_STD = sp.Symbol("distance_std", nonnegative=True)
QUANTILE, NEAREST = sp.symbols("quantile nearest", real=True)


def nearest_block():
    """Return the program of the distance that a target keeps with a probability.

    The distance has the variance u' P u, with u the direction from the point to the target: with
    h = (u, 0), f = U' h and b = D f it is a sum of squares, f' b.
    """
    along = dict(zip(GRADIENT, (*DIRECTION, 0, 0, 0), strict=True))
    projection = projection_stage()
    assignments = [(name, value.subs(along)) for name, value in projection.assignments]
    squares = sum(f * b for f, b in zip(PROJECTION, WEIGHTED, strict=True))
    used = set().union(*(value.free_symbols for _, value in assignments))
    return Block(
        name="nearest",
        summary="Distance to a point, its standard deviation, and its quantile.",
        inputs=(*STATE[:3], *(u for u in FACTORS if u in used), *POINT, QUANTILE),
        stages=(
            Stage(
                "away from the point",
                [(a, x - q) for a, x, q in zip(AWAY, STATE[:3], POINT, strict=True)],
            ),
            Stage("distance", [(DISTANCE, sp.sqrt(sum(a**2 for a in AWAY)))]),
            Stage(
                "direction",
                [
                    (INVERSE, 1 / DISTANCE),
                    *((u, a * INVERSE) for u, a in zip(DIRECTION, AWAY, strict=True)),
                ],
            ),
            Stage(projection.comment, assignments),
            Stage("standard deviation", [(DISTANCE_STD, sp.sqrt(squares))]),
            Stage("quantile", [(NEAREST, DISTANCE + QUANTILE * DISTANCE_STD)]),
        ),
        outputs=(DISTANCE, DISTANCE_STD, NEAREST),
    )
