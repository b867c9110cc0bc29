"""Åsheim (2015): a person tracked with two UWB pulse-Doppler radars that measure no angle.

Tracking a person using UWB pulse Doppler radar, master's thesis, NTNU Trondheim.
"""

from ..._lazy import attach
from .expected_error import error_area, one_scan_bound
from .experiments import baseline_sweep, late_radar, refused_scans, usable_ranges
from .in_the_plane import central_filter, table_3_2
from .many_detections import false_tracks, managed_tracks, on_track, pda_radar
from .measures import (
    departure,
    distance_error,
    rmse,
    rmse_interval,
    rmse_ratio,
    usable_interval,
    usable_range,
    usable_ratio,
)
from .one_radar import RadarTrack, filter_radar
from .published import (
    Settings,
    deviations,
    quoted,
    resolutions,
    scenario,
    settings,
    snr,
)
from .scene import (
    Records,
    maneuver_track,
    noisy_positions,
    radars,
    scan_times,
    simulate,
    straight_track,
)
from .stand_in import Walk, walk
from .two_radars import PositionTrack, filter_then_triangulate, raw_positions, triangulate

__all__ = [
    "PositionTrack",
    "RadarTrack",
    "Records",
    "Settings",
    "Walk",
    "baseline_sweep",
    "central_filter",
    "departure",
    "deviations",
    "distance_error",
    "error_area",
    "false_tracks",
    "filter_radar",
    "filter_then_triangulate",
    "late_radar",
    "managed_tracks",
    "maneuver_track",
    "noisy_positions",
    "on_track",
    "one_scan_bound",
    "pda_radar",
    "quoted",
    "radars",
    "raw_positions",
    "refused_scans",
    "resolutions",
    "rmse",
    "rmse_interval",
    "rmse_ratio",
    "scan_times",
    "scenario",
    "settings",
    "simulate",
    "snr",
    "straight_track",
    "table_3_2",
    "triangulate",
    "usable_interval",
    "usable_range",
    "usable_ranges",
    "usable_ratio",
    "walk",
]

__getattr__, __dir__ = attach(__name__, __path__)
