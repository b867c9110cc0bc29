# Made by python -m tools.stubs; do not edit.
from . import frequency as frequency
from . import front_end as front_end
from . import fsk as fsk
from . import impairments as impairments
from . import interpolation as interpolation
from . import laws as laws
from . import phase as phase
from . import real_tone as real_tone
from . import recording as recording
from . import rinex as rinex
from . import sliding as sliding
from . import spectrogram as spectrogram
from . import synthesis as synthesis
from . import validity as validity
from . import waveforms as waveforms
