"""The start of the report: one descent from one guess to the nearest optimum."""

import numpy as np

from ... import _checks
from ...kernels.doppler import doppler_shift_and_gradient


def local_start(z, array, guess, box, gradient="exact"):
    """Minimize the squared misfit to the average of some samples, from one guess.

    Parameters
    ----------
    z : array_like, shape (runs, K, N)
        Doppler measurements in Hz.
    array : RadarArray
        The N sensors.
    guess : array_like, shape (6,)
        Where the search begins.
    box : pair of array_like, shape (6,)
        Lower and upper bounds of the state.
    gradient : {"exact", "differences"}
        What guides the search. The report leaves it to SciPy, which takes finite differences;
        they end within about their own noise of the exact gradient, and take several times as
        long.

    Returns
    -------
    x : ndarray, shape (runs, 6)
        Where the search ended.
    misfit : ndarray, shape (runs,)
        Sum of the squared residuals there, in Hz^2.
    converged : ndarray of bool, shape (runs,)
        Whether it says that it succeeded.

    Raises
    ------
    ValueError
        If `gradient` is unknown or an argument has the wrong shape.

    Notes
    -----
    L-BFGS-B of SciPy (Byrd et al. 1995) with its defaults. The state is taken as constant during
    the samples. Whether the optimum is the best one is not asked.
    """
    from scipy.optimize import minimize  # here: it takes longer to load than all the rest

    z = _checks.finite("z", z, (None, None, len(array)))
    exact = _checks.one_of("gradient", gradient, ("exact", "differences")) == "exact"
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
