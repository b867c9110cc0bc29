"""Recordings of IQ samples: SigMF, WAV and FLAC, one file for all sensors or one for each."""

from ._joining import align
from ._recording import Recording
from ._sigmf import read_sigmf, write_sigmf
from ._wav import read_wav, write_wav

__all__ = ["Recording", "align", "read_sigmf", "read_wav", "write_sigmf", "write_wav"]
