"""The Doppler model as mathematics, and the printers that turn it into code.

Everything numeric in the library that involves a derivative starts here, as a SymPy expression
typed once. ``python -m dopplerlib.derive`` prints it into `dopplerlib.kernels`. This is the only
package that imports SymPy; no other package imports it.
"""

from .._lazy import attach, require

require("sympy", extra="derive")
__getattr__, __dir__ = attach(__name__, __path__)
