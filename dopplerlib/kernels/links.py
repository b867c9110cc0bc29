"""Doppler shift of a point target at a sensor that moves, and its gradient.

Printed by ``python -m dopplerlib.derive`` with SymPy 1.14.0. Do not edit: change
`dopplerlib.derive` and print again (``make kernels``).
"""

from numpy import sqrt


def leg_shift(x, y, z, v_x, v_y, v_z, s_x, s_y, s_z, u_x, u_y, u_z,
        doppler_per_speed):
    r"""Doppler shift along a leg in Hz, positive when it gets shorter.

    .. math::

        \begin{aligned}
        d_{x} &= s_{x} - x \\
        d_{y} &= s_{y} - y \\
        d_{z} &= s_{z} - z \\
        w_{x} &= - u_{x} + v_{x} \\
        w_{y} &= - u_{y} + v_{y} \\
        w_{z} &= - u_{z} + v_{z} \\
        \rho &= \sqrt{d_{x}^{2} + d_{y}^{2} + d_{z}^{2}} \\
        h &= \frac{2 \left(d_{x} w_{x} + d_{y} w_{y} + d_{z} w_{z}\right)}{\lambda \rho} \\
        \mathtt{doppler\_per\_speed} &= \frac{2}{\lambda}
        \end{aligned}
    """
    # line of sight and inverse range
    d_x = s_x - x
    d_y = s_y - y
    d_z = s_z - z
    inverse_range = 1/sqrt(d_x*d_x + d_y*d_y + d_z*d_z)
    # velocity of the target, seen from the sensor
    w_x = -u_x + v_x
    w_y = -u_y + v_y
    w_z = -u_z + v_z
    # Doppler shift, Eq 6 with that velocity
    shift = doppler_per_speed*inverse_range*(d_x*w_x + d_y*w_y + d_z*w_z)
    return shift


def leg_shift_and_gradient(x, y, z, v_x, v_y, v_z, s_x, s_y, s_z, u_x, u_y,
        u_z, doppler_per_speed):
    r"""Doppler shift along a leg and its derivatives by x, y, z, v_x, v_y, v_z.

    .. math::

        \begin{aligned}
        d_{x} &= s_{x} - x \\
        d_{y} &= s_{y} - y \\
        d_{z} &= s_{z} - z \\
        w_{x} &= - u_{x} + v_{x} \\
        w_{y} &= - u_{y} + v_{y} \\
        w_{z} &= - u_{z} + v_{z} \\
        \rho &= \sqrt{d_{x}^{2} + d_{y}^{2} + d_{z}^{2}} \\
        h &= \frac{2 \left(d_{x} w_{x} + d_{y} w_{y} + d_{z} w_{z}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial x} &= \frac{2 \left(\frac{d_{x} \left(d_{x} w_{x} + d_{y} w_{y} + d_{z} w_{z}\right)}{\rho^{2}} - w_{x}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial y} &= \frac{2 \left(\frac{d_{y} \left(d_{x} w_{x} + d_{y} w_{y} + d_{z} w_{z}\right)}{\rho^{2}} - w_{y}\right)}{\lambda \rho} \\
        \frac{\partial h}{\partial z} &= \frac{2 \left(\frac{d_{z} \left(d_{x} w_{x} + d_{y} w_{y} + d_{z} w_{z}\right)}{\rho^{2}} - w_{z}\right)}{\lambda \rho} \\
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
    # velocity of the target, seen from the sensor
    w_x = -u_x + v_x
    w_y = -u_y + v_y
    w_z = -u_z + v_z
    # Doppler shift, Eq 6 with that velocity
    t0 = d_x*w_x + d_y*w_y + d_z*w_z
    t1 = doppler_per_speed*inverse_range
    shift = t0*t1
    t2 = (inverse_range*inverse_range)*t0
    h_x = t1*(d_x*t2 - w_x)
    h_y = t1*(d_y*t2 - w_y)
    h_z = t1*(d_z*t2 - w_z)
    h_vx = d_x*t1
    h_vy = d_y*t1
    h_vz = d_z*t1
    return shift, h_x, h_y, h_z, h_vx, h_vy, h_vz
