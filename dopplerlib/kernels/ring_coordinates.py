"""Coordinates in which a ring of sensors sees no scale, and motion in them.

Printed by ``python -m dopplerlib.derive`` with SymPy 1.14.0. Do not edit: change
`dopplerlib.derive` and print again (``make kernels``).
"""

from numpy import sqrt


def shift_and_gradient(eta_y, eta_z, beta_y, beta_z, b, u, x, v_x, s_x, s_y,
        s_z, r, doppler_per_speed):
    """Doppler shift in Hz; derivatives by eta, beta, b and ln rho, and by x and v_x."""
    # rho over the distance of sensor and target
    inverse_root = 1/sqrt(-2*eta_y*s_y - 2*eta_z*s_z + (u*u)*(-(r*r) + s_x*s_x - 2*s_x*x + s_y*s_y + s_z*s_z) + 1)
    # shift and gradient
    t0 = -b + beta_y*s_y + beta_z*s_z + s_x*u*v_x
    t1 = doppler_per_speed*inverse_root
    shift = t0*t1
    t2 = doppler_per_speed*(inverse_root*inverse_root*inverse_root)*t0
    h_etay = s_y*t2
    h_etaz = s_z*t2
    h_betay = s_y*t1
    h_betaz = s_z*t1
    h_b = -t1
    t3 = t1*u
    h_ell = -t3*(-(inverse_root*inverse_root)*t0*u*(-(r*r) + s_x*s_x - 2*s_x*x + s_y*s_y + s_z*s_z) + s_x*v_x)
    h_x = s_x*t2*(u*u)
    h_vx = s_x*t3
    return shift, h_etay, h_etaz, h_betay, h_betaz, h_b, h_ell, h_x, h_vx


def to_coordinates(x, y, z, v_x, v_y, v_z, r):
    """Coordinates eta, beta, b of a state in m and m/s, and its rho in m."""
    # range
    rho = sqrt(r*r + x*x + y*y + z*z)
    # coordinates
    t0 = 1/(rho*rho)
    eta_y = t0*y
    eta_z = t0*z
    t1 = 1/rho
    beta_y = t1*v_y
    beta_z = t1*v_z
    b = t1*(v_x*x + v_y*y + v_z*z)
    return eta_y, eta_z, beta_y, beta_z, b, rho


def to_state(eta_y, eta_z, beta_y, beta_z, b, rho, r):
    """State with x > 0 at eta, beta, b and rho; its derivatives by them and ln rho."""
    # state
    t0 = rho*rho
    y = eta_y*t0
    z = eta_z*t0
    v_y = beta_y*rho
    v_z = beta_z*rho
    x = sqrt(-(r*r) + t0 - (y*y) - (z*z))
    v_x = (b*rho - v_y*y - v_z*z)/x
    # derivatives that are not zero
    t1 = 1/x
    t2 = rho*rho
    t3 = t1*t2
    d_x_etay = -t3*y
    d_x_etaz = -t3*z
    t4 = 2*eta_y
    t5 = 2*eta_z
    d_x_ell = -t3*(t4*y + t5*z - 1)
    d_y_etay = t2
    d_y_ell = t2*t4
    d_z_etaz = t2
    d_z_ell = t2*t5
    t6 = v_x*y
    t7 = 1/(x*x)
    t8 = t2*t7
    d_vx_etay = -t8*(-t6 + v_y*x)
    t9 = v_x*z
    d_vx_etaz = -t8*(-t9 + v_z*x)
    t10 = rho*t1
    d_vx_betay = -t10*y
    d_vx_betaz = -t10*z
    d_vx_b = t10
    t11 = rho*t4
    t12 = rho*t5
    d_vx_ell = -rho*t7*(-b*x + beta_y*x*y + beta_z*x*z + rho*v_x - t11*t6 + t11*v_y*x - t12*t9 + t12*v_z*x)
    d_vy_betay = rho
    d_vy_ell = beta_y*rho
    d_vz_betaz = rho
    d_vz_ell = beta_z*rho
    return (x, y, z, v_x, v_y, v_z, d_x_etay, d_x_etaz, d_x_ell, d_y_etay, d_y_ell,
            d_z_etaz, d_z_ell, d_vx_etay, d_vx_etaz, d_vx_betay, d_vx_betaz,
            d_vx_b, d_vx_ell, d_vy_betay, d_vy_ell, d_vz_betaz, d_vz_ell)


def moved(eta_y, eta_z, beta_y, beta_z, b, u, V, V_etay, V_etaz, V_betay,
        V_betaz, V_b, V_ell, T):
    """Coordinates and growth of rho after T at constant velocity; their derivatives."""
    # growth of rho
    growth = sqrt((T*T)*V*(u*u) + 2*T*b*u + 1)
    # coordinates
    t0 = 1/(growth*growth)
    t1 = T*u
    eta_y_new = t0*(beta_y*t1 + eta_y)
    eta_z_new = t0*(beta_z*t1 + eta_z)
    t2 = 1/growth
    beta_y_new = beta_y*t2
    beta_z_new = beta_z*t2
    b_new = t2*(V*t1 + b)
    # derivatives
    t7 = 1/(growth*growth*growth*growth)
    t8 = T*u
    t9 = beta_y*t8
    t10 = t7*(eta_y + t9)
    t5 = T*T
    t6 = t5*(u*u)
    t11 = t10*t6
    t3 = 1/(growth*growth)
    t4 = -t3
    f_etay_etay = -V_etay*t11 - t4
    f_etay_etaz = -V_etaz*t11
    t12 = -T*t3*u
    f_etay_betay = -V_betay*t11 - t12
    f_etay_betaz = -V_betaz*t11
    t13 = V_b*t6 + 2*t8
    f_etay_b = -t10*t13
    t14 = V_ell*t6 - u*(2*T*b + 2*V*t5*u)
    f_etay_ell = -t10*t14 - t3*t9
    t15 = t7*(beta_z*t8 + eta_z)
    t16 = t15*t6
    f_etaz_etay = -V_etay*t16
    f_etaz_etaz = -V_etaz*t16 - t4
    f_etaz_betay = -V_betay*t16
    f_etaz_betaz = -V_betaz*t16 - t12
    f_etaz_b = -t13*t15
    f_etaz_ell = -beta_z*t3*t8 - t14*t15
    t17 = (1/2)/(growth*growth*growth)
    t18 = beta_y*t17
    t19 = t18*t6
    f_betay_etay = -V_etay*t19
    f_betay_etaz = -V_etaz*t19
    t20 = 1/growth
    t21 = -t20
    f_betay_betay = -V_betay*t19 - t21
    f_betay_betaz = -V_betaz*t19
    f_betay_b = -t13*t18
    f_betay_ell = -t14*t18
    t22 = beta_z*t17
    t23 = t22*t6
    f_betaz_etay = -V_etay*t23
    f_betaz_etaz = -V_etaz*t23
    f_betaz_betay = -V_betay*t23
    f_betaz_betaz = -V_betaz*t23 - t21
    f_betaz_b = -t13*t22
    f_betaz_ell = -t14*t22
    t24 = V*t8
    t25 = t17*(b + t24)
    t26 = t25*t6
    f_b_etay = T*V_etay*t20*u - V_etay*t26
    f_b_etaz = T*V_etaz*t20*u - V_etaz*t26
    f_b_betay = T*V_betay*t20*u - V_betay*t26
    f_b_betaz = T*V_betaz*t20*u - V_betaz*t26
    f_b_b = V_b*t20*t8 - t13*t25 + t20
    f_b_ell = T*V_ell*t20*u - t14*t25 - t20*t24
    t27 = (1/2)*t3
    t28 = t27*t6
    f_ell_etay = V_etay*t28
    f_ell_etaz = V_etaz*t28
    f_ell_betay = V_betay*t28
    f_ell_betaz = V_betaz*t28
    f_ell_b = t13*t27
    f_ell_ell = t14*t27 + 1
    return (eta_y_new, eta_z_new, beta_y_new, beta_z_new, b_new, growth,
            f_etay_etay, f_etay_etaz, f_etay_betay, f_etay_betaz, f_etay_b,
            f_etay_ell, f_etaz_etay, f_etaz_etaz, f_etaz_betay, f_etaz_betaz,
            f_etaz_b, f_etaz_ell, f_betay_etay, f_betay_etaz, f_betay_betay,
            f_betay_betaz, f_betay_b, f_betay_ell, f_betaz_etay, f_betaz_etaz,
            f_betaz_betay, f_betaz_betaz, f_betaz_b, f_betaz_ell, f_b_etay,
            f_b_etaz, f_b_betay, f_b_betaz, f_b_b, f_b_ell, f_ell_etay, f_ell_etaz,
            f_ell_betay, f_ell_betaz, f_ell_b, f_ell_ell)


def pushed(x, y, z, v_x, v_y, v_z, rho, c_x, c_y, c_z, c_v_x, c_v_y, c_v_z):
    """Change of eta, beta, b and ln rho along a small change of the state."""
    # derivative along the change
    t0 = 1/(rho*rho)
    t1 = c_x*x
    t2 = 2*t0
    t3 = t2*y
    t4 = c_z*z
    c_etay = t0*(c_y*(-t2*(y*y) + 1) - t1*t3 - t3*t4)
    t5 = t2*z
    t6 = c_y*y
    c_etaz = t0*(c_z*(-t2*(z*z) + 1) - t1*t5 - t5*t6)
    t7 = 1/rho
    t8 = t0*v_y
    t9 = v_y*y
    c_betay = t7*(c_v_y - c_y*t0*t9 - t1*t8 - t4*t8)
    t10 = t0*v_z
    t11 = v_z*z
    c_betaz = t7*(c_v_z - c_z*t0*t11 - t1*t10 - t10*t6)
    t12 = t0*(t11 + t9 + v_x*x)
    c_b = t7*(c_v_x*x + c_v_y*y + c_v_z*z + c_x*(-t12*x + v_x) + c_y*(-t12*y + v_y) + c_z*(-t12*z + v_z))
    c_ell = t0*(t1 + t4 + t6)
    return c_etay, c_etaz, c_betay, c_betaz, c_b, c_ell
