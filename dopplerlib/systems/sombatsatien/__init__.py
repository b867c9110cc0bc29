"""Sombatsatien's report: the paper's system rebuilt by a student, whose filter loses the target.

Doppler-only tracking implementation, a report with a notebook on Mittermaier et al. (2016).
"""

from .local_start import local_start
from .post_mortem import PostMortem, mirrored, post_mortem, repairs
from .published import StartSettings, reported, reported_record, scenario, start_settings
from .student_filter import student_ekf, student_jacobian

__all__ = [
    "PostMortem",
    "StartSettings",
    "local_start",
    "mirrored",
    "post_mortem",
    "repairs",
    "reported",
    "reported_record",
    "scenario",
    "start_settings",
    "student_ekf",
    "student_jacobian",
]
