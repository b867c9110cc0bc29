# Made by python -m tools.stubs; do not edit.
from . import asheim2015 as asheim2015
from . import macaveiu2013 as macaveiu2013
from . import mittermaier2016 as mittermaier2016
from . import sombatsatien as sombatsatien
from . import valarmathi as valarmathi
