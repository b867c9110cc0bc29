"""Mittermaier et al. (2016): six Doppler sensors on a ring, one target, an EKF.

Extended Kalman Doppler tracking and model determination for multi-sensor short-range radar,
Adv. Radio Sci. 14, 39-46, doi:10.5194/ars-14-39-2016.
"""

from ..._lazy import attach
from ...chain.baseband import Baseband
from .causes import Consistency, consistency_runs, matched_P0, range_claims, switched_ekf
from .chain_bounds import median_error, position_bound, position_bound_iq, record_for
from .chain_errors import Judged, judged
from .end_to_end import track_iq
from .error_map import ErrorMap, comparable, figure3, figure3_bound, shares_above
from .faults import faulty_filters, linear_filter, linear_world
from .figure6_readings import Figure6Readings, figure6_readings, ruled_out, still_counts
from .map_readings import ORIENTATIONS, Reading, figure3_readings, figure3_score
from .noise_sweep import (
    Figure4,
    SweepReading,
    error_limits,
    figure4,
    figure4_array,
    grid_points,
    noise_levels,
)
from .phase_fit import fit_phases
from .published import (
    PublishedFigure3,
    PublishedFigure4,
    PublishedFigure6,
    Table2,
    figure4_settings,
    published_figure3,
    published_figure4,
    published_figure6,
    quoted,
    scenario,
    signal_chain,
    table2,
)
from .race import RACE, RACE_LEVELS, Race, race_cell, race_windows, saved_race
from .received_iq import FAULTS, received
from .simulated_iq import SIMULATED, read_simulated_iq, simulated_recording, write_simulated_iq
from .start import Starts, samples_needed, start_box, start_misfit, table2_starts
from .sweep_readings import (
    dots_log_likelihood,
    dots_structure,
    figure4_readings,
    figure4_score,
    saved_figure4,
    scored_levels,
    sweep_readings,
)
from .tracking import Figure6, figure6
from .white_noise import WalkFilter, walk_filter

__all__ = [
    "FAULTS",
    "ORIENTATIONS",
    "RACE",
    "RACE_LEVELS",
    "SIMULATED",
    "Baseband",
    "Consistency",
    "ErrorMap",
    "Figure4",
    "Figure6",
    "Figure6Readings",
    "Judged",
    "PublishedFigure3",
    "PublishedFigure4",
    "PublishedFigure6",
    "Race",
    "Reading",
    "Starts",
    "SweepReading",
    "Table2",
    "WalkFilter",
    "comparable",
    "consistency_runs",
    "dots_log_likelihood",
    "dots_structure",
    "error_limits",
    "faulty_filters",
    "figure3",
    "figure3_bound",
    "figure3_readings",
    "figure3_score",
    "figure4",
    "figure4_array",
    "figure4_readings",
    "figure4_score",
    "figure4_settings",
    "figure6",
    "figure6_readings",
    "fit_phases",
    "grid_points",
    "judged",
    "linear_filter",
    "linear_world",
    "matched_P0",
    "median_error",
    "noise_levels",
    "position_bound",
    "position_bound_iq",
    "published_figure3",
    "published_figure4",
    "published_figure6",
    "quoted",
    "race_cell",
    "race_windows",
    "range_claims",
    "read_simulated_iq",
    "received",
    "record_for",
    "ruled_out",
    "samples_needed",
    "saved_figure4",
    "saved_race",
    "scenario",
    "scored_levels",
    "shares_above",
    "signal_chain",
    "simulated_recording",
    "start_box",
    "start_misfit",
    "still_counts",
    "sweep_readings",
    "switched_ekf",
    "table2",
    "table2_starts",
    "track_iq",
    "walk_filter",
    "write_simulated_iq",
]

__getattr__, __dir__ = attach(__name__, __path__)
