"""The start of the report: one descent from one guess to the nearest optimum."""

import numpy as np

from ... import _checks
from ..._hints import Measurements, State, checked
from ..._typing import BoolArray, FloatArray
from ...kernels.doppler import doppler_shift_and_gradient
from ...model.radar_array import RadarArray


@checked
def local_start(
    z: Measurements,
    array: RadarArray,
    guess: State,
    box: tuple[State, State],
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Minimize the squared misfit to the average of some samples, from one guess.

    z (runs, K, N): Doppler measurements in Hz.
    array: The N sensors.
    guess (6,): Where the search begins.
    box (6,): Lower and upper bounds of the state.
    Returns x (runs, 6): Where the search ended.
        misfit (runs,): Sum of the squared residuals there, in Hz^2.
        converged (runs,): Whether it says that it succeeded.
    Raises ValueError if an argument has the wrong shape, or a lower bound is above the upper one.

    Notes
    -----
    L-BFGS-B of SciPy (Byrd et al. 1995) with its defaults and the exact gradient. The report gives
    it none, so that it takes forward differences; where those end in a flat valley hangs on the
    last bit of the shifts, so that two computers stop millimeters apart. The state is taken as
    constant during the samples. Whether the optimum is the best one is not asked.

    Examples
    --------
    >>> from dopplerlib import RadarArray
    >>> box = [0.1, -1, -0.5, -2, -1, -1], [2, 1, 0.5, 0, 1, 1]
    >>> guess, z = [0.5, 0, 0.1, -0.5, 0, 0], np.full((1, 2, 6), 100.0)
    >>> local_start(z, RadarArray.ring(6, 0.2, normal="z"), guess, box)[0].shape
    (1, 6)
    """
    from scipy.optimize import minimize  # here: it takes longer to load than all the rest

    _checks.check_shape("z", z, (len(array),))
    if (box[0] > box[1]).any():
        raise ValueError(f"box must have no lower bound above the upper one, got {box}")
    bounds = list(zip(*box, strict=True))
    sensors = *array.positions.T, array.doppler_per_speed
    x, misfit = np.empty((len(z), 6)), np.empty(len(z))
    converged = np.empty(len(z), bool)

    for run, measured in enumerate(z.mean(axis=1)):

        def squares(state, measured=measured):
            # The kernel itself: checking the arguments would take longer than the rest.
            shift, *gradient = doppler_shift_and_gradient(*state, *sensors)
            residual = shift - measured
            return residual @ residual, 2 * np.array(gradient) @ residual

        found = minimize(
            squares, guess, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": 1000}
        )
        x[run], misfit[run], converged[run] = found.x, found.fun, found.success
    return x, misfit, converged
