"""Mittermaier et al. (2016): six Doppler sensors on a ring, one target, an EKF.

Extended Kalman Doppler tracking and model determination for multi-sensor short-range radar,
Adv. Radio Sci. 14, 39-46, doi:10.5194/ars-14-39-2016.
"""

from .causes import Consistency, consistency_runs, matched_P0, range_claims, switched_ekf
from .faults import faulty_filters, linear_filter, linear_world
from .published import PublishedFigure6, Table2, published_figure6, quoted, scenario, table2
from .tracking import Figure6, figure6

__all__ = [
    "Consistency",
    "Figure6",
    "PublishedFigure6",
    "Table2",
    "consistency_runs",
    "faulty_filters",
    "figure6",
    "linear_filter",
    "linear_world",
    "matched_P0",
    "published_figure6",
    "quoted",
    "range_claims",
    "scenario",
    "switched_ekf",
    "table2",
]
