"""The text of every module in `dopplerlib.kernels`."""

import sympy as sp

from . import doppler, ekf, links, ring_coordinates
from .doppler import GRADIENT, STATE
from .printers import python_function, python_lanes

_HEAD = '''"""{title}

Printed by ``python -m dopplerlib.derive`` with SymPy {version}. Do not edit: change
`dopplerlib.derive` and print again (``make kernels``).
"""
'''


def kernel_sources():
    """Return {file name: text} of the modules that `dopplerlib.kernels` holds."""
    target = "Doppler shift of a point target at {}, and its gradient."
    return {
        "doppler.py": _shift_and_gradient(target.format("a fixed sensor"), doppler),
        "links.py": _shift_and_gradient(target.format("a sensor that moves"), links),
        "ekf.py": _ekf(),
        "ring_coordinates.py": _ring_coordinates(),
    }


def _shift_and_gradient(title, module):
    return "\n".join(
        [
            _head(title),
            "from numpy import sqrt\n\n",
            python_function(module.shift_block()) + "\n",
            python_function(module.gradient_block()),
        ]
    )


def _ekf():
    arrays = {
        "work": {
            "PREDICTED": STATE,
            "FACTORS": ekf.FACTORS,
            "CORRECTION": ekf.CORRECTION,
            "NIS": [ekf.NIS],
            "COVARIANCE": ekf.COVARIANCE,
            "ROWS": [],
        },
        "sensor": {
            "MEASUREMENT": [ekf.MEASUREMENT],
            "VARIANCE": [ekf.VARIANCE],
            "INNOVATION": [ekf.INNOVATION],
            "GRADIENT": GRADIENT,
            "PROJECTION": ekf.PROJECTION,
            "WEIGHTED": ekf.WEIGHTED,
            "SENSOR_ROWS": [],
        },
    }
    places, layout = {}, []
    for array, sections in arrays.items():
        start = 0
        for name, symbols in sections.items():
            layout.append(f"{name} = {start}")
            # An updated quantity replaces the old one in place.
            for row, symbol in enumerate(symbols, start):
                new = sp.Symbol(f"{symbol.name}_new", real=True)
                places[symbol] = places[new] = array, row
            start += len(symbols)
    return "\n".join(
        [
            _head("One cycle of the EKF for constant velocity and Doppler measurements."),
            "from numpy import sqrt\n",
            "# First row of each quantity in the array `work`, and in `sensor`, of which every\n"
            "# sensor has one. Of matrices the upper triangle is kept, row by row. That of the\n"
            "# factors of P = U D U' holds U, and D in place of the ones on the diagonal of U.",
            *layout,
            "\n",
            "\n\n".join(python_lanes(block, places) for block in ekf.blocks()),
        ]
    )


def _ring_coordinates():
    return "\n".join(
        [
            _head("Coordinates in which a ring of sensors sees no scale, and motion in them."),
            "from numpy import sqrt\n\n",
            "\n\n".join(python_function(block) for block in ring_coordinates.blocks()),
        ]
    )


def _head(title):
    return _HEAD.format(title=title, version=sp.__version__)
