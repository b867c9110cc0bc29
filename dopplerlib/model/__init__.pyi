# Made by python -m tools.stubs; do not edit.
from . import ambiguity as ambiguity
from . import broadcast_orbit as broadcast_orbit
from . import coordinated_turn as coordinated_turn
from . import doppler as doppler
from . import earth as earth
from . import information as information
from . import iso_doppler as iso_doppler
from . import links as links
from . import motion as motion
from . import polar_radar as polar_radar
from . import radar_array as radar_array
from . import range_rate as range_rate
from . import ranging_noise as ranging_noise
from . import ring_coordinates as ring_coordinates
from . import scenario as scenario
from . import simulation as simulation
from . import twin as twin
