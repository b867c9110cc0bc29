"""Åsheim (2015): a person tracked with two UWB pulse-Doppler radars that measure no angle.

Tracking a person using UWB pulse Doppler radar, master's thesis, NTNU Trondheim.
"""

from ..._lazy import attach, by_name

_HOME = by_name(
    {
        "published": "Reported reported",
        "noise": "noise_std resolutions snr",
        "settings": "FilterSettings filter_settings",
        "scene": "RadarRecords maneuver_track noisy_positions radar_positions scan_times "
        "simulate_radars straight_track",
        "range_tracker": "RangeTrack track_ranges",
        "position_tracker": "PositionTrack clipped_bilateration filter_then_bilaterate "
        "raw_positions",
        "cartesian_tracker": "central_filter range_and_angle range_and_angle_jacobian table_3_2",
        "multi_detection": "false_tracks managed_tracks on_track pda_ranges",
        "measures": "departure_times position_errors rmse rmse_interval rmse_ratio "
        "usable_interval usable_range usable_ratio",
        "expected_error": "error_area one_scan_bound",
        "surrogate": "SurrogateWalk simulate_walk",
        "comparisons": "baseline_sweep late_radar rejected_scans usable_ranges",
    }
)
__all__ = sorted(_HOME)
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
