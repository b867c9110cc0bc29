"""Mittermaier et al. (2016): six Doppler sensors on a ring, one target, an EKF.

Extended Kalman Doppler tracking and model determination for multi-sensor short-range radar,
Adv. Radio Sci. 14, 39-46, doi:10.5194/ars-14-39-2016.
"""

from .noise_sweep import LEVELS, Figure4, Reading, figure4
from .published import (
    PublishedFigure4,
    PublishedFigure6,
    Table2,
    published_figure4,
    published_figure6,
    quoted,
    scenario,
    table2,
)
from .readings import READINGS, SCORED, log_likelihood, saved_figure4, score, scored_readings, structure
from .tracking import Figure6, figure6

__all__ = [
    "LEVELS",
    "READINGS",
    "SCORED",
    "Figure4",
    "Figure6",
    "PublishedFigure4",
    "PublishedFigure6",
    "Reading",
    "Table2",
    "figure4",
    "figure6",
    "log_likelihood",
    "published_figure4",
    "published_figure6",
    "quoted",
    "scenario",
    "saved_figure4",
    "score",
    "scored_readings",
    "structure",
    "table2",
]
