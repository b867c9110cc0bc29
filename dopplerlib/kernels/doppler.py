"""Doppler shift of a point target at a fixed sensor, and its gradient.

Printed by ``python -m dopplerlib.derive`` with SymPy 1.14.0. Do not edit: change
`dopplerlib.derive` and print again (``make kernels``).
"""

from numpy import sqrt


def doppler_shift(x, y, z, v_x, v_y, v_z, s_x, s_y, s_z, doppler_per_speed):
    r"""Doppler shift in Hz, positive when approaching (Eq 6).

    .. math::

        \begin{aligned}
        d_{x} &= s_{x} - x \\
        d_{y} &= s_{y} - y \\
        d_{z} &= s_{z} - z \\
        \rho &= \sqrt{d_{x}^{2} + d_{y}^{2} + d_{z}^{2}} \\
        h &= \frac{2 \left(d_{x} v_{x} + d_{y} v_{y} + d_{z} v_{z}\right)}{\lambda \rho} \\
        \mathtt{doppler\_per\_speed} &= \frac{2}{\lambda}
        \end{aligned}
    """
    # line of sight and inverse range
    d_x = s_x - x
    d_y = s_y - y
    d_z = s_z - z
    inverse_range = 1/sqrt(d_x*d_x + d_y*d_y + d_z*d_z)
    # Doppler shift, Eq 6
    shift = doppler_per_speed*inverse_range*(d_x*v_x + d_y*v_y + d_z*v_z)
    return shift


def doppler_shift_and_gradient(x, y, z, v_x, v_y, v_z, s_x, s_y, s_z,
        doppler_per_speed):
    r"""Doppler shift in Hz and its derivatives by x, y, z, v_x, v_y, v_z (Eqs 6, 7).

    .. math::

        \begin{aligned}
        d_{x} &= s_{x} - x \\
        d_{y} &= s_{y} - y \\
        d_{z} &= s_{z} - z \\
        \rho &= \sqrt{d_{x}^{2} + d_{y}^{2} + d_{z}^{2}} \\
        h &= \frac{2 \left(d_{x} v_{x} + d_{y} v_{y} + d_{z} v_{z}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial x} &= \frac{2 \left(\frac{d_{x} \left(d_{x} v_{x} + d_{y} v_{y} + d_{z} v_{z}\right)}{\rho^{2}} - v_{x}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial y} &= \frac{2 \left(\frac{d_{y} \left(d_{x} v_{x} + d_{y} v_{y} + d_{z} v_{z}\right)}{\rho^{2}} - v_{y}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial z} &= \frac{2 \left(\frac{d_{z} \left(d_{x} v_{x} + d_{y} v_{y} + d_{z} v_{z}\right)}{\rho^{2}} - v_{z}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial v_{x}} &= \frac{2 d_{x}}{\lambda \rho} \\
        \frac{\partial h}{\partial v_{y}} &= \frac{2 d_{y}}{\lambda \rho} \\
        \frac{\partial h}{\partial v_{z}} &= \frac{2 d_{z}}{\lambda \rho} \\
        \mathtt{doppler\_per\_speed} &= \frac{2}{\lambda}
        \end{aligned}
    """
    # line of sight and inverse range
    d_x = s_x - x
    d_y = s_y - y
    d_z = s_z - z
    inverse_range = 1/sqrt(d_x*d_x + d_y*d_y + d_z*d_z)
    # Doppler shift, Eq 6, and its gradient, Eq 7
    t0 = d_x*v_x + d_y*v_y + d_z*v_z
    t1 = doppler_per_speed*inverse_range
    shift = t0*t1
    t2 = (inverse_range*inverse_range)*t0
    h_x = t1*(d_x*t2 - v_x)
    h_y = t1*(d_y*t2 - v_y)
    h_z = t1*(d_z*t2 - v_z)
    h_vx = d_x*t1
    h_vy = d_y*t1
    h_vz = d_z*t1
    return shift, h_x, h_y, h_z, h_vx, h_vy, h_vz
