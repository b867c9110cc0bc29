# Made by python -m tools.stubs; do not edit.
from . import doppler as doppler
from . import ekf as ekf
from . import links as links
from . import ring_coordinates as ring_coordinates
