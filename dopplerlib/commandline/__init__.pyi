# Made by python -m tools.stubs; do not edit.
from . import main as main
from . import report as report
