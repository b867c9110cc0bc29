"""Mittermaier et al. (2016): six Doppler sensors on a ring, one target, an EKF.

Extended Kalman Doppler tracking and model determination for multi-sensor short-range radar,
Adv. Radio Sci. 14, 39-46, doi:10.5194/ars-14-39-2016.
"""

from .causes import Consistency, consistency_runs, matched_P0, switched_ekf
from .chain_errors import Judged, judged, position_bound
from .end_to_end import (
    FAULTS,
    Baseband,
    EndToEnd,
    received,
    track_iq,
)
from .error_map import ErrorMap, comparable, figure3, figure3_bound, shares_above
from .faults import faulty_filters, linear_filter, linear_world
from .map_readings import ORIENTATIONS, Reading, figure3_readings, figure3_score
from .published import (
    PublishedFigure3,
    PublishedFigure6,
    Table2,
    published_figure3,
    published_figure6,
    quoted,
    scenario,
    signal_chain,
    table2,
)
from .simulated_iq import (
    SIMULATED,
    read_simulated_iq,
    simulated_recording,
    write_simulated_iq,
)
from .start import Starts, samples_needed, start_box, start_misfit, table2_starts
from .tracking import Figure6, figure6
from .white_noise import WalkFilter, walk_filter

__all__ = [
    "FAULTS",
    "ORIENTATIONS",
    "SIMULATED",
    "Baseband",
    "Consistency",
    "EndToEnd",
    "ErrorMap",
    "Figure6",
    "Judged",
    "PublishedFigure3",
    "PublishedFigure6",
    "Reading",
    "Starts",
    "Table2",
    "WalkFilter",
    "comparable",
    "consistency_runs",
    "faulty_filters",
    "figure3",
    "figure3_bound",
    "figure3_readings",
    "figure3_score",
    "figure6",
    "judged",
    "linear_filter",
    "linear_world",
    "matched_P0",
    "position_bound",
    "published_figure3",
    "published_figure6",
    "quoted",
    "read_simulated_iq",
    "received",
    "samples_needed",
    "scenario",
    "shares_above",
    "signal_chain",
    "simulated_recording",
    "start_box",
    "start_misfit",
    "switched_ekf",
    "table2",
    "table2_starts",
    "track_iq",
    "walk_filter",
    "write_simulated_iq",
]
