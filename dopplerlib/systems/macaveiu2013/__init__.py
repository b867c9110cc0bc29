"""Macaveiu, Campeanu, Nafornita (2013): an automotive radar, its waveforms, and a linear filter.

Estimation of Automotive Target Trajectories by Kalman Filtering, Buletinul Stiintific al
Universitatii Politehnica din Timisoara, Seria Electronica si Telecomunicatii, 58(72).

Functions of the same name in several modules are reached through the module: `chain`,
`chain_study`, `crossing`, `lag`, `maneuvers`, `polar`, `regions`,
`signals`, `tracking`.
"""

from ..._lazy import attach
from . import (
    chain,
    chain_study,
    crossing,
    lag,
    maneuvers,
    polar,
    regions,
    signals,
    tracking,
)
from .published import KMH, Path2D, Settings, hard_turn, paths, settings

__all__ = [
    "KMH",
    "Path2D",
    "Settings",
    "chain",
    "chain_study",
    "crossing",
    "hard_turn",
    "lag",
    "maneuvers",
    "paths",
    "polar",
    "regions",
    "settings",
    "signals",
    "tracking",
]

__getattr__, __dir__ = attach(__name__, __path__)
