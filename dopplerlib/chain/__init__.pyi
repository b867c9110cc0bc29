# Made by python -m tools.stubs; do not edit.
from . import alarm as alarm
from . import alternatives as alternatives
from . import baseband as baseband
from . import collision as collision
from . import phase_fit as phase_fit
from . import receiver as receiver
from . import ridges as ridges
from . import satellites as satellites
from . import setup as setup
from . import simulation as simulation
from . import track as track
