"""Names of types for the hints of the public edge."""

from importlib.resources.abc import Traversable
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["ArrayLike", "BoolArray", "ComplexArray", "FileSource", "FloatArray", "IntArray"]

BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complexfloating]
FloatArray = NDArray[np.floating]
IntArray = NDArray[np.integer]
FileSource = str | PathLike[str] | Traversable  # of a file that is read
