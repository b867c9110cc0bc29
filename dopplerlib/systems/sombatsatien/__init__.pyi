# Made by python -m tools.stubs; do not edit.
from . import descent as descent
from . import diagnosis as diagnosis
from . import evidence as evidence
from . import published as published
from . import student_filter as student_filter
from . import variants as variants
from .descent import local_start as local_start
from .diagnosis import final_bound as final_bound
from .diagnosis import measures as measures
from .diagnosis import mirrored as mirrored
from .diagnosis import nearer_to_twin as nearer_to_twin
from .diagnosis import outcomes as outcomes
from .diagnosis import reported_outcomes as reported_outcomes
from .published import Reported as Reported
from .published import reported as reported
from .student_filter import student_ekf as student_ekf
from .student_filter import student_jacobian as student_jacobian
from .variants import PostMortem as PostMortem
from .variants import consistent_runs as consistent_runs
from .variants import post_mortem as post_mortem
from .variants import repairs as repairs
from .variants import reported_record as reported_record
from .variants import ring_scenario as ring_scenario

__all__ = [
    "PostMortem",
    "Reported",
    "consistent_runs",
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
    "ring_scenario",
    "student_ekf",
    "student_jacobian",
]
