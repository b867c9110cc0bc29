# Made by python -m tools.stubs; do not edit.
from . import ablation as ablation
from . import combinations as combinations
from . import example as example
from . import faults as faults
from . import maps as maps
from . import noise_sweep as noise_sweep
