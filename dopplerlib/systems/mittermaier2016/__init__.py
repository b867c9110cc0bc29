"""Mittermaier et al. (2016): six Doppler sensors on a ring, one target, an EKF.

Extended Kalman Doppler tracking and model determination for multi-sensor short-range radar,
Adv. Radio Sci. 14, 39-46, doi:10.5194/ars-14-39-2016.
"""

from .error_map import ErrorMap, figure3, figure3_bound, shares_above
from .map_readings import ORIENTATIONS, Reading, figure3_readings, figure3_score
from .published import (
    PublishedFigure3,
    PublishedFigure6,
    Table2,
    published_figure3,
    published_figure6,
    quoted,
    scenario,
    table2,
)
from .start import Starts, samples_needed, start_box, start_misfit, table2_starts
from .tracking import Figure6, figure6

__all__ = [
    "ORIENTATIONS",
    "ErrorMap",
    "Figure6",
    "PublishedFigure3",
    "PublishedFigure6",
    "Reading",
    "Starts",
    "Table2",
    "figure3",
    "figure3_bound",
    "figure3_readings",
    "figure3_score",
    "figure6",
    "published_figure3",
    "published_figure6",
    "quoted",
    "samples_needed",
    "scenario",
    "shares_above",
    "start_box",
    "start_misfit",
    "table2",
    "table2_starts",
]
