"""Recordings of IQ samples: SigMF, WAV, FLAC and .npy, one file for all sensors or one for each."""

from ._joining import align
from ._npy import read_npy
from ._recording import Recording
from ._sigmf import read_sigmf, write_sigmf
from ._wav import read_wav, write_wav

__all__ = ["Recording", "align", "read_npy", "read_sigmf", "read_wav", "write_sigmf", "write_wav"]
