"""Macaveiu, Campeanu, Nafornita (2013): an automotive radar, its waveforms, and a linear filter.

Estimation of Automotive Target Trajectories by Kalman Filtering, Buletinul Stiintific al
Universitatii Politehnica din Timisoara, Seria Electronica si Telecomunicatii, 58(72).
"""

from ..._lazy import attach, by_name

_HOME = by_name(
    {
        "published": "KMH Reported reported",
        "settings": "AutomotiveSettings automotive_settings",
        "truth": "VehiclePath hard_turn vehicle_paths",
        "signals": "CAR PEDESTRIAN SLOPES noisy_echoes",
        "linear_filter": "VehicleRuns filter_vehicle gain_sequence measure_vehicle track_vehicle "
        "tracking_errors",
        "lag_prediction": "acceleration_lag best_w settled_noise_std settled_rms velocity_response",
        "claim_regions": "CLAIMS PathScores claim_borders claim_borders_along claim_map "
        "decided_claims score_paths",
        "processing": "CLUTTER MANAGER TARGET VehicleScan after_clutter_rule group_detections "
        "hidden_scans is_moving longest_gap reflection_points simulate_scans track_objects",
        "processing_study": "DetectionCounts SchemeOutcome count_detections deleted_fraction "
        "outcome_summary saved_detections saved_outcomes study_outcome study_record study_variants",
        "polar_filters": "measure_polar polar_noise start_polar track_polar track_polar_naive",
        "motion_models": "rms_of_runs smooth_vehicle track_accelerating track_two_models",
        "model_comparison": "AGILE JERKS STAYS STEPS model_errors saved_model_errors",
        "crossing": "Crossing RULES crossing_paths track_crossing",
    }
)
__all__ = sorted(_HOME)
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
