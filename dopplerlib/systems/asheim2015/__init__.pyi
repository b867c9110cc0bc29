# Made by python -m tools.stubs; do not edit.
from . import cartesian_tracker as cartesian_tracker
from . import comparisons as comparisons
from . import evidence as evidence
from . import expected_error as expected_error
from . import measures as measures
from . import multi_detection as multi_detection
from . import noise as noise
from . import position_tracker as position_tracker
from . import published as published
from . import range_tracker as range_tracker
from . import scene as scene
from . import settings as settings
from . import surrogate as surrogate
from .cartesian_tracker import central_filter as central_filter
from .cartesian_tracker import range_and_angle as range_and_angle
from .cartesian_tracker import range_and_angle_jacobian as range_and_angle_jacobian
from .cartesian_tracker import table_3_2 as table_3_2
from .comparisons import baseline_sweep as baseline_sweep
from .comparisons import late_radar as late_radar
from .comparisons import rejected_scans as rejected_scans
from .comparisons import usable_ranges as usable_ranges
from .expected_error import error_area as error_area
from .expected_error import one_scan_bound as one_scan_bound
from .measures import departure_times as departure_times
from .measures import position_errors as position_errors
from .measures import rmse as rmse
from .measures import rmse_interval as rmse_interval
from .measures import rmse_ratio as rmse_ratio
from .measures import usable_interval as usable_interval
from .measures import usable_range as usable_range
from .measures import usable_ratio as usable_ratio
from .multi_detection import false_tracks as false_tracks
from .multi_detection import managed_tracks as managed_tracks
from .multi_detection import on_track as on_track
from .multi_detection import pda_ranges as pda_ranges
from .noise import noise_std as noise_std
from .noise import resolutions as resolutions
from .noise import snr as snr
from .position_tracker import PositionTrack as PositionTrack
from .position_tracker import clipped_bilateration as clipped_bilateration
from .position_tracker import filter_then_bilaterate as filter_then_bilaterate
from .position_tracker import raw_positions as raw_positions
from .published import Reported as Reported
from .published import reported as reported
from .range_tracker import RangeTrack as RangeTrack
from .range_tracker import track_ranges as track_ranges
from .scene import RadarRecords as RadarRecords
from .scene import maneuver_track as maneuver_track
from .scene import noisy_positions as noisy_positions
from .scene import radar_positions as radar_positions
from .scene import scan_times as scan_times
from .scene import simulate_radars as simulate_radars
from .scene import straight_track as straight_track
from .settings import FilterSettings as FilterSettings
from .settings import filter_settings as filter_settings
from .surrogate import SurrogateWalk as SurrogateWalk
from .surrogate import simulate_walk as simulate_walk

__all__ = [
    "FilterSettings",
    "PositionTrack",
    "RadarRecords",
    "RangeTrack",
    "Reported",
    "SurrogateWalk",
    "baseline_sweep",
    "central_filter",
    "clipped_bilateration",
    "departure_times",
    "error_area",
    "false_tracks",
    "filter_settings",
    "filter_then_bilaterate",
    "late_radar",
    "managed_tracks",
    "maneuver_track",
    "noise_std",
    "noisy_positions",
    "on_track",
    "one_scan_bound",
    "pda_ranges",
    "position_errors",
    "radar_positions",
    "range_and_angle",
    "range_and_angle_jacobian",
    "raw_positions",
    "rejected_scans",
    "reported",
    "resolutions",
    "rmse",
    "rmse_interval",
    "rmse_ratio",
    "scan_times",
    "simulate_radars",
    "simulate_walk",
    "snr",
    "straight_track",
    "table_3_2",
    "track_ranges",
    "usable_interval",
    "usable_range",
    "usable_ranges",
    "usable_ratio",
]
