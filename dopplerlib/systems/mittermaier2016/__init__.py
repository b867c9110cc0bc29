"""Mittermaier et al. (2016): six Doppler sensors on a ring, one target, an EKF.

Extended Kalman Doppler tracking and model determination for multi-sensor short-range radar,
Adv. Radio Sci. 14, 39-46, doi:10.5194/ars-14-39-2016.
"""

from ..._lazy import attach, by_name

_HOME = by_name(
    {
        "published": "PublishedFigure3 PublishedFigure4 PublishedFigure6 Reported reported",
        "start": "Starts samples_needed start_box start_misfit table2_starts",
        "error_maps": "ErrorMap comparable error_map error_map_bound fraction_above",
        "noise_sweep": "NoiseSweep SweepReading error_limits grid_points mean_norm noise_levels"
        " run_noise_sweep sweep_array sweep_bounds",
        "example": "ExampleRuns run_example",
        "end_to_end": "track_iq",
        "chain_bounds": "median_error position_bound position_bound_iq record_length",
        "chain_errors": "TrackErrors track_errors",
        "chain_sums": "saved_sum_errors sum_errors",
        "simulated_iq": "SIMULATED read_simulated_iq simulated_recording write_simulated_iq",
        "readings.ablation": "Consistency ablated_ekf consistency_runs matched_P0 range_claims",
        "readings.combinations": "combination_runs saved_combinations",
        "readings.faults": "faulty_filters linear_filter linear_world",
        "readings.maps": "ORIENTATIONS MapReading map_readings map_score",
        "readings.noise_sweep": "DotsStructure coarse_readings dots_log_likelihood dots_structure"
        " saved_coarse_sweeps saved_noise_sweep saved_sweep_readings scored_levels sweep_readings"
        " sweep_score",
        "readings.example": "ExampleReadings example_readings example_summary ruled_out"
        " still_counts",
    }
)
__all__ = sorted(_HOME)
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
