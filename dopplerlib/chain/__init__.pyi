# Made by python -m tools.stubs; do not edit.
from . import baseband as baseband
from . import phase_fit as phase_fit
from . import ridges as ridges
from . import simulation as simulation
from . import track as track
