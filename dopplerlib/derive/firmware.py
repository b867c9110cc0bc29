"""C99 for firmware: one cycle of the filter and the decision to stop, from the same formulas.

The formulas are printed from their blocks; what is written here is the order in which they are
called. The text allocates nothing and keeps no state of its own.
"""

from collections import Counter
from dataclasses import replace

import sympy as sp

from . import ekf, stop
from ._firmware_text import HEADER, SOURCE
from .block import Block, Stage
from .doppler import GRADIENT, SENSOR, STATE
from .operations import KINDS, count_operations
from .printers import c99_in_place

NAME = "doppler_tracker"

SIGMA_A, HALF, DISPLACEMENT, SPEED = sp.symbols("sigma_a half g_p g_v", real=True)
NOTHING = sp.Symbol("nothing", positive=True)  # of what size, the precision decides
STACK = {"double": 1024, "float": 512}  # bytes of stack that a call takes, at most

_ARRAYS = {
    "state": STATE,
    "factors": ekf.FACTORS,
    "noise": ekf.NOISE,
    "sensor": SENSOR,
    "linear": (ekf.INNOVATION, *GRADIENT),
    "correction": (*ekf.CORRECTION, ekf.NIS),
    "upper": ekf.COVARIANCE,
    "gain": (DISPLACEMENT, SPEED),
    "point": stop.POINT,
    "found": (stop.DISTANCE, stop.DISTANCE_STD, stop.NEAREST),
}


def gain_block():
    """Return the program of G sigma_a: the displacement and the speed of one axis (Eq 9)."""
    return Block(
        name="gains",
        summary="Displacement and speed that an acceleration sigma_a adds in T (Eq 9).",
        inputs=(ekf.T, SIGMA_A),
        stages=(
            Stage("half the square of T", [(HALF, ekf.T**2 / 2)]),
            Stage("gains", [(DISPLACEMENT, SIGMA_A * HALF), (SPEED, SIGMA_A * ekf.T)]),
        ),
        outputs=(DISPLACEMENT, SPEED),
    )


def noise_block():
    """Return that of `ekf.noise_block`, with its tiny number as an argument."""
    block = ekf.noise_block()
    (stage,) = block.stages
    named = [(name, value.xreplace({ekf.NOTHING: NOTHING})) for name, value in stage.assignments]
    return replace(
        block, inputs=(*block.inputs, NOTHING), stages=(replace(stage, assignments=named),)
    )


def correct_block():
    """Return the program that adds what the sensors have corrected to the predicted state."""
    new = [sp.Symbol(f"{x.name}_new", real=True) for x in STATE]
    corrected = [x + c for x, c in zip(STATE, ekf.CORRECTION, strict=True)]
    return Block(
        name="correct",
        summary="Corrected state (Table 1).",
        inputs=(*STATE, *ekf.CORRECTION),
        stages=(Stage("state", list(zip(new, corrected, strict=True))),),
        outputs=tuple(new),
    )


def blocks():
    """Return the blocks that are printed, in the order in which they are used."""
    return (
        ekf.predict_block(),
        gain_block(),
        noise_block(),
        ekf.linearize_block(),
        ekf.update_block(),
        correct_block(),
        ekf.covariance_block(),
        stop.nearest_block(),
    )


def firmware_sources():
    """Return {file name: text} of the header and the source, in C99."""
    places = {}
    for array, symbols in _ARRAYS.items():
        for index, symbol in enumerate(symbols):
            new = sp.Symbol(f"{symbol.name}_new", real=True)
            places[symbol] = places[new] = array, index
    printed = blocks()
    filled = {
        "{version}": sp.__version__,
        "{operations}": _operations({block.name: count_operations(block) for block in printed}),
        "{blocks}": "\n".join(c99_in_place(block, places) for block in printed),
    } | {f"{{{precision}}}": str(size) for precision, size in STACK.items()}
    sources = {f"{NAME}.h": HEADER, f"{NAME}.c": SOURCE}
    for key, text in filled.items():
        sources = {name: source.replace(key, text) for name, source in sources.items()}
    return sources


def _operations(count):
    """Return a line of the header for each kind: of a cycle that uses all sensors, and to stop."""
    once, column, sensor, decision = (
        sum((count[name] for name in names.split()), Counter())
        for names in ("predict gains correct", "add_noise", "linearize update", "nearest")
    )
    return "\n".join(
        f" *   {kind:<16}{once[kind]:>4} + {column[kind]:>2} C + {sensor[kind]:>3} N"
        f"{decision[kind]:>12}"
        for kind in KINDS
    )
