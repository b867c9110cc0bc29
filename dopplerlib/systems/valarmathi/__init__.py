"""Valarmathi et al.: a velocity from the Doppler shift, with a fixed or an adaptive window, fused.

Valarmathi, Emmanuel and Christopher: Doppler information optimization through fusion algorithms.
"""

from ..._lazy import attach, by_name

_HOME = by_name(
    {
        "published": "Reported reported",
        "velocity_paths": "VelocityPath velocity_path",
        "window_choice": "WindowTable cumulative_error",
        "window_transform": "FilteredDoppler doppler_filter measurement_variance",
        "velocity_filter": "VelocityTrack filter_velocity",
        "window_simulation": "window_table",
        "window_law": "best_lengths best_window law_exponents law_rmse linear_cost linear_error",
        "algorithms": "ALGORITHMS AlgorithmRuns operations run_algorithms",
        "residual_noise": "residual_variance updated_residual",
        "error_measures": "run_measures",
        "fusion_sweep": "FusionSweep saved_sweep sweep_cell",
        "fusion_study": "FusionStudy cell_measures failure_limit saved_failures saved_study "
        "study_cell study_table",
        "fusion": "FusedTrack ablation calibration error_correlation fuse_all fusion_errors "
        "fusion_summary matched_model merged_doppler",
    }
)
__all__ = sorted(_HOME)
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
