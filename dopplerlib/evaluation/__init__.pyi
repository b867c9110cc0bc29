# Made by python -m tools.stubs; do not edit.
from . import alarms as alarms
from . import averages as averages
from . import bootstrap as bootstrap
from . import bounds as bounds
from . import checklist as checklist
from . import colored_noise as colored_noise
from . import consistency as consistency
from . import directions as directions
from . import error_correlation as error_correlation
from . import frequency_benchmark as frequency_benchmark
from . import intervals as intervals
from . import noise_fit as noise_fit
from . import observability as observability
from . import power as power
from . import range_bounds as range_bounds
from . import table as table
from . import whiteness as whiteness
