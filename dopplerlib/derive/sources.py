"""The text of every module in `dopplerlib.kernels`."""

import sympy as sp

from . import ekf
from .doppler import GRADIENT, STATE, gradient_block, shift_block
from .printers import python_function, python_lanes

_HEAD = '''"""{title}

Printed by ``python -m dopplerlib.derive`` with SymPy {version}. Do not edit: change
`dopplerlib.derive` and print again (``make kernels``).
"""
'''


def kernel_sources():
    """Return {file name: text} of the modules that `dopplerlib.kernels` holds."""
    return {"doppler.py": _doppler(), "ekf.py": _ekf()}


def _doppler():
    return "\n".join(
        [
            _head("Doppler shift of a point target at a fixed sensor, and its gradient."),
            "from numpy import sqrt\n\n",
            python_function(shift_block()) + "\n",
            python_function(gradient_block()),
        ]
    )


def _ekf():
    sections = {
        "PREDICTED": STATE,
        "COVARIANCE": ekf.COVARIANCE,
        "CORRECTION": ekf.CORRECTION,
        "NIS": [ekf.NIS],
        "MEASUREMENT": [ekf.MEASUREMENT],
        "SEEN": [ekf.SEEN],
        "INNOVATION": [ekf.INNOVATION],
        "GRADIENT": GRADIENT,
        "PROCESS_NOISE": ekf.PROCESS_NOISE,
    }
    rows, layout, start = {}, [], 0
    for name, symbols in sections.items():
        layout.append(f"{name} = {start}")
        # An updated quantity replaces the old one in place.
        for row, symbol in enumerate(symbols, start):
            rows[symbol] = rows[sp.Symbol(f"{symbol.name}_new", real=True)] = row
        start += len(symbols)
    layout.append(f"ROWS = {start}")
    return "\n".join(
        [
            _head("One cycle of the EKF for constant velocity and Doppler measurements."),
            "from numpy import sqrt\n",
            "# First row of each quantity in the work array. Of a symmetric matrix the upper\n"
            "# triangle is kept, row by row.",
            *layout,
            "\n",
            python_lanes(ekf.predict_block(), rows) + "\n",
            python_lanes(ekf.update_block(), rows),
        ]
    )


def _head(title):
    return _HEAD.format(title=title, version=sp.__version__)
