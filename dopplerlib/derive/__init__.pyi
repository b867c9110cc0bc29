# Made by python -m tools.stubs; do not edit.
from . import block as block
from . import doppler as doppler
from . import ekf as ekf
from . import firmware as firmware
from . import links as links
from . import operations as operations
from . import printers as printers
from . import ring as ring
from . import ring_coordinates as ring_coordinates
from . import snapshot as snapshot
from . import sources as sources
from . import stop as stop
