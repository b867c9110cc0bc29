"""Sombatsatien's report: the paper's system rebuilt by a student, whose filter loses the target.

Doppler-only tracking implementation, a report with a notebook on Mittermaier et al. (2016).
"""

from ..._lazy import attach
from .claims import evidence
from .local_start import local_start
from .post_mortem import (
    PostMortem,
    consistent_runs,
    final_bound,
    measures,
    mirrored,
    nearer_to_twin,
    outcomes,
    post_mortem,
    repairs,
)
from .published import (
    StartSettings,
    reported,
    reported_outcomes,
    reported_record,
    scenario,
    start_settings,
)
from .student_filter import student_ekf, student_jacobian

__all__ = [
    "PostMortem",
    "StartSettings",
    "consistent_runs",
    "evidence",
    "final_bound",
    "local_start",
    "measures",
    "mirrored",
    "nearer_to_twin",
    "outcomes",
    "post_mortem",
    "repairs",
    "reported",
    "reported_outcomes",
    "reported_record",
    "scenario",
    "start_settings",
    "student_ekf",
    "student_jacobian",
]

__getattr__, __dir__ = attach(__name__, __path__)
