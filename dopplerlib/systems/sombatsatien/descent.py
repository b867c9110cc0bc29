"""The start of the report: one descent from one guess to the nearest optimum."""

from typing import Literal

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
    gradient: Literal["exact", "differences"] = "exact",
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Minimize the squared misfit to the average of some samples, from one guess.

    z (runs, K, N): Doppler measurements in Hz.
    array: The N sensors.
    guess (6,): Where the search begins.
    box (6,): Lower and upper bounds of the state.
    gradient: What guides the search. The report leaves it to SciPy, which takes finite differences;
        they end within about their own noise of the exact gradient, and take several times as long.
    Returns x (runs, 6): Where the search ended.
        misfit (runs,): Sum of the squared residuals there, in Hz^2.
        converged (runs,): Whether it says that it succeeded.
    Raises ValueError if `gradient` is unknown, an argument has the wrong shape, or a lower bound is
        above the upper one.

    Notes
    -----
    L-BFGS-B of SciPy (Byrd et al. 1995) with its defaults. The state is taken as constant during
    the samples. Whether the optimum is the best one is not asked.

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
    exact = gradient == "exact"
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
            if not exact:
                return residual @ residual
            return residual @ residual, 2 * np.array(gradient) @ residual

        found = minimize(
            squares, guess, jac=exact, method="L-BFGS-B", bounds=bounds, options={"maxiter": 1000}
        )
        x[run], misfit[run], converged[run] = found.x, found.fun, found.success
    return x, misfit, converged
