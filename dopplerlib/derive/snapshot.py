"""Why a ring sees five numbers and not six.

`dopplerlib.derive.ring` proves that the states of a family look alike. Here is the other half, that
nothing else is lost: the gradient of the shift around a circle is a polynomial with five
coefficients.
"""

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from .._hints import checked
from . import ring
from ._arguments import RationalMatrix

POINT = sp.Symbol("zeta")  # exp(i varphi) for a sensor at the angle varphi


def ring_harmonics():
    """Return the (5, 6) matrix of what a ring's snapshot says about `ring.INVARIANTS`.

    The derivative of the shift of a sensor at `ring.ANGLE` by the six invariants, times the
    wavelength and the third power of the range, is the row (1, cos, sin, cos 2, sin 2) of that
    angle times this matrix. Such rows of five sensors at different places are independent, so
    every ring of five sensors or more has the rank of this matrix, and none has more than five.
    """
    shift = ring.shift_on_circle()
    on_circle = {
        sp.cos(ring.ANGLE): (POINT + 1 / POINT) / 2,
        sp.sin(ring.ANGLE): (POINT - 1 / POINT) / (2 * sp.I),
    }
    s = ring.sensor_on_circle()
    A, y, z, *_ = ring.INVARIANTS
    square = A - 2 * (s[1] * y + s[2] * z)
    columns = []
    for invariant in ring.INVARIANTS:
        # The derivative of M / sqrt(D) times D^(3/2): its two terms lose their roots one by one.
        terms = sp.Add.make_args(sp.diff(shift, invariant) * ring.WAVELENGTH)
        numerator = sum(sp.powsimp(term * square ** sp.Rational(3, 2)) for term in terms)
        polynomial = sp.Poly(sp.expand(sp.expand(numerator).subs(on_circle) * POINT**2), POINT)
        # A sixth coefficient would be one too many to unpack.
        coefficients = polynomial.all_coeffs()[::-1]
        m2, m1, c0, p1, p2 = coefficients + [sp.S.Zero] * (5 - len(coefficients))
        real = [c0, p1 + m1, sp.I * (p1 - m1), p2 + m2, sp.I * (p2 - m2)]
        columns.append([sp.expand(coefficient) for coefficient in real])
    return sp.Matrix(columns).T


@checked
def rank(matrix: RationalMatrix) -> int:
    """Return the rank of a matrix of rational functions, for generic values of its symbols.

    Parameters
    ----------
    matrix : sympy.Matrix
        Its numbers are fractions: of decimals no rank is exact.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> rank(sp.Matrix([[1, x], [1 / x, 1]]))
    1
    """
    return DomainMatrix.from_Matrix(matrix).to_field().rank()


def family_of_invariants():
    """Return the direction of the family in `ring.INVARIANTS`: (2A, 2y, 2z, w, v_y, v_z)."""
    A, y, z, w, v_y, v_z = ring.INVARIANTS
    return sp.Matrix([2 * A, 2 * y, 2 * z, w, v_y, v_z])


def prove_harmonics_miss_the_family():
    """Return `ring_harmonics` times `family_of_invariants`."""
    return (ring_harmonics() @ family_of_invariants()).expand()
