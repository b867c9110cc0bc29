# Made by python -m tools.stubs; do not edit.
from . import comparison as comparison
from . import demands as demands
from . import errors as errors
from . import fault_study as fault_study
from . import faults as faults
from . import layout_results as layout_results
from . import layouts as layouts
from . import stop_study as stop_study
from . import stopping as stopping
from . import targets as targets
from . import trackers as trackers
from . import yardsticks as yardsticks
