# Made by python -m tools.stubs; do not edit.
from . import targets as targets
