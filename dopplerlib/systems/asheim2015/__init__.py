"""Åsheim (2015): a person tracked with two UWB pulse-Doppler radars that measure no angle.

Tracking a person using UWB pulse Doppler radar, master's thesis, NTNU Trondheim.
"""

from .experiments import late_radar, usable_ranges
from .measures import departure, distance_error, over_runs, rmse, usable_range
from .one_radar import RadarTrack, filter_radar
from .published import Settings, deviations, quoted, resolutions, scenario, settings, snr
from .scene import (
    Records,
    maneuver_track,
    noisy_positions,
    radars,
    scan_times,
    simulate,
    straight_track,
)
from .stand_in import Walk, managed_tracks, pda_radar, walk
from .two_radars import (
    PositionTrack,
    central_filter,
    error_area,
    filter_then_triangulate,
    one_scan_bound,
    raw_positions,
    table_3_2,
    triangulate,
)

__all__ = [
    "PositionTrack",
    "RadarTrack",
    "Records",
    "Settings",
    "Walk",
    "central_filter",
    "departure",
    "deviations",
    "distance_error",
    "error_area",
    "filter_radar",
    "filter_then_triangulate",
    "late_radar",
    "managed_tracks",
    "maneuver_track",
    "noisy_positions",
    "one_scan_bound",
    "over_runs",
    "pda_radar",
    "quoted",
    "radars",
    "raw_positions",
    "resolutions",
    "rmse",
    "scan_times",
    "scenario",
    "settings",
    "simulate",
    "snr",
    "straight_track",
    "table_3_2",
    "triangulate",
    "usable_range",
    "usable_ranges",
    "walk",
]
