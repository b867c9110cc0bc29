"""Sombatsatien's report: the paper's system rebuilt by a student, whose filter loses the target.

Doppler-only tracking implementation, a report with a notebook on Mittermaier et al. (2016).
"""

from ..._lazy import attach, by_name

_HOME = by_name(
    {
        "published": "Reported reported",
        "descent": "local_start",
        "student_filter": "student_ekf student_jacobian",
        "variants": "PostMortem consistent_runs post_mortem repairs reported_record ring_scenario",
        "diagnosis": "final_bound measures mirrored nearer_to_twin outcomes reported_outcomes",
    }
)
__all__ = sorted(_HOME)
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
