# Made by python -m tools.stubs; do not edit.
from . import baseband as baseband
from . import track as track
