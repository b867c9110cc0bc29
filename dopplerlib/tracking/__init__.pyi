# Made by python -m tools.stubs; do not edit.
from . import association as association
from . import bilateration as bilateration
from . import fusion as fusion
from . import gates as gates
from . import management as management
from . import multi_target as multi_target
from . import pda as pda
