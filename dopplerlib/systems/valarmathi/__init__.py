"""Valarmathi et al.: a velocity from the Doppler shift, with a fixed or an adaptive window, fused.

Valarmathi, Emmanuel and Christopher: Doppler information optimization through fusion algorithms.
"""

from ..._lazy import attach
from .algorithms import ALGORITHMS, AlgorithmRuns, run_algorithms
from .claims import evidence
from .doppler_filter import FilteredDoppler, doppler_filter, measurement_variance
from .filters import VelocityTrack, filter_velocity
from .modern import (
    error_correlation,
    fusion_errors,
    fusion_summary,
    fusions,
    gains,
    honesty,
    merged_doppler,
    supposed_world,
)
from .noise import residual_variance, updated_residual
from .published import VelocityPath, chosen, data_file, stated, velocity_path
from .study import (
    Study,
    cell_measures,
    failed_shares,
    failure_limit,
    saved_study,
    study_cell,
    study_table,
)
from .window_law import best_window, law_exponents, law_rmse, linear_cost, plane_error
from .windows import WindowTable, choose_window, cumulative_error, window_table

__all__ = [
    "ALGORITHMS",
    "AlgorithmRuns",
    "FilteredDoppler",
    "Study",
    "VelocityPath",
    "VelocityTrack",
    "WindowTable",
    "best_window",
    "cell_measures",
    "choose_window",
    "chosen",
    "cumulative_error",
    "data_file",
    "doppler_filter",
    "error_correlation",
    "evidence",
    "failed_shares",
    "failure_limit",
    "filter_velocity",
    "fusion_errors",
    "fusion_summary",
    "fusions",
    "gains",
    "honesty",
    "law_exponents",
    "law_rmse",
    "linear_cost",
    "measurement_variance",
    "merged_doppler",
    "plane_error",
    "residual_variance",
    "run_algorithms",
    "saved_study",
    "stated",
    "study_cell",
    "study_table",
    "supposed_world",
    "updated_residual",
    "velocity_path",
    "window_table",
]

__getattr__, __dir__ = attach(__name__, __path__)
