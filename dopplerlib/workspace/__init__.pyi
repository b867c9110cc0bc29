# Made by python -m tools.stubs; do not edit.
from . import faults as faults
from . import stopping as stopping
from . import targets as targets
