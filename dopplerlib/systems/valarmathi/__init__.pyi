# Made by python -m tools.stubs; do not edit.
from . import algorithms as algorithms
from . import error_measures as error_measures
from . import evidence as evidence
from . import fusion as fusion
from . import fusion_study as fusion_study
from . import fusion_sweep as fusion_sweep
from . import published as published
from . import residual_noise as residual_noise
from . import velocity_filter as velocity_filter
from . import velocity_paths as velocity_paths
from . import window_choice as window_choice
from . import window_law as window_law
from . import window_simulation as window_simulation
from . import window_transform as window_transform
from .algorithms import ALGORITHMS as ALGORITHMS
from .algorithms import AlgorithmRuns as AlgorithmRuns
from .algorithms import operations as operations
from .algorithms import run_algorithms as run_algorithms
from .error_measures import run_measures as run_measures
from .fusion import FusedTrack as FusedTrack
from .fusion import ablation as ablation
from .fusion import calibration as calibration
from .fusion import error_correlation as error_correlation
from .fusion import fuse_all as fuse_all
from .fusion import fusion_errors as fusion_errors
from .fusion import fusion_summary as fusion_summary
from .fusion import matched_model as matched_model
from .fusion import merged_doppler as merged_doppler
from .fusion_study import FusionStudy as FusionStudy
from .fusion_study import cell_measures as cell_measures
from .fusion_study import failure_limit as failure_limit
from .fusion_study import saved_failures as saved_failures
from .fusion_study import saved_study as saved_study
from .fusion_study import study_cell as study_cell
from .fusion_study import study_table as study_table
from .fusion_sweep import FusionSweep as FusionSweep
from .fusion_sweep import saved_sweep as saved_sweep
from .fusion_sweep import sweep_cell as sweep_cell
from .published import Reported as Reported
from .published import reported as reported
from .residual_noise import residual_variance as residual_variance
from .residual_noise import updated_residual as updated_residual
from .velocity_filter import VelocityTrack as VelocityTrack
from .velocity_filter import filter_velocity as filter_velocity
from .velocity_paths import VelocityPath as VelocityPath
from .velocity_paths import velocity_path as velocity_path
from .window_choice import WindowTable as WindowTable
from .window_choice import cumulative_error as cumulative_error
from .window_law import best_lengths as best_lengths
from .window_law import best_window as best_window
from .window_law import law_exponents as law_exponents
from .window_law import law_rmse as law_rmse
from .window_law import linear_cost as linear_cost
from .window_law import linear_error as linear_error
from .window_simulation import window_table as window_table
from .window_transform import FilteredDoppler as FilteredDoppler
from .window_transform import doppler_filter as doppler_filter
from .window_transform import measurement_variance as measurement_variance

__all__ = [
    "ALGORITHMS",
    "AlgorithmRuns",
    "FilteredDoppler",
    "FusedTrack",
    "FusionStudy",
    "FusionSweep",
    "Reported",
    "VelocityPath",
    "VelocityTrack",
    "WindowTable",
    "ablation",
    "best_lengths",
    "best_window",
    "calibration",
    "cell_measures",
    "cumulative_error",
    "doppler_filter",
    "error_correlation",
    "failure_limit",
    "filter_velocity",
    "fuse_all",
    "fusion_errors",
    "fusion_summary",
    "law_exponents",
    "law_rmse",
    "linear_cost",
    "linear_error",
    "matched_model",
    "measurement_variance",
    "merged_doppler",
    "operations",
    "reported",
    "residual_variance",
    "run_algorithms",
    "run_measures",
    "saved_failures",
    "saved_study",
    "saved_sweep",
    "study_cell",
    "study_table",
    "sweep_cell",
    "updated_residual",
    "velocity_path",
    "window_table",
]
