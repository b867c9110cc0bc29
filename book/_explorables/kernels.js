// Printed by `make kernels`. Do not edit: change dopplerlib.derive and print again.
"use strict";

const kernels = (() => {
function doppler_shift(x, y, z, v_x, v_y, v_z, s_x, s_y, s_z,
        doppler_per_speed) {
    const d_x = s_x - x;
    const d_y = s_y - y;
    const d_z = s_z - z;
    const inverse_range = 1/Math.sqrt(d_x*d_x + d_y*d_y + d_z*d_z);
    const shift = doppler_per_speed*inverse_range*(d_x*v_x + d_y*v_y + d_z*v_z);
    return [shift];
}

function doppler_shift_and_gradient(x, y, z, v_x, v_y, v_z, s_x, s_y, s_z,
        doppler_per_speed) {
    const d_x = s_x - x;
    const d_y = s_y - y;
    const d_z = s_z - z;
    const inverse_range = 1/Math.sqrt(d_x*d_x + d_y*d_y + d_z*d_z);
    const t0 = d_x*v_x + d_y*v_y + d_z*v_z;
    const t1 = doppler_per_speed*inverse_range;
    const shift = t0*t1;
    const t2 = (inverse_range*inverse_range)*t0;
    const h_x = t1*(d_x*t2 - v_x);
    const h_y = t1*(d_y*t2 - v_y);
    const h_z = t1*(d_z*t2 - v_z);
    const h_vx = d_x*t1;
    const h_vy = d_y*t1;
    const h_vz = d_z*t1;
    return [shift, h_x, h_y, h_z, h_vx, h_vy, h_vz];
}

function ring_family_state(x, y, z, v_x, v_y, v_z, r, t) {
    const A = r*r + x*x + y*y + z*z;
    const w = v_x*x + v_y*y + v_z*z;
    const t0 = t*t;
    const y_new = t0*y;
    const z_new = t0*z;
    const v_y_new = t*v_y;
    const v_z_new = t*v_z;
    const x_new = Math.sqrt(A*t0 - (r*r) - (y_new*y_new) - (z_new*z_new));
    const v_x_new = (t*w - v_y_new*y_new - v_z_new*z_new)/x_new;
    return [x_new, y_new, z_new, v_x_new, v_y_new, v_z_new];
}

function predict(x, y, z, v_x, v_y, v_z, U_x_vx, U_x_vy, U_x_vz, U_y_vy,
        U_y_vz, U_z_vz, U_vx_vy, U_vx_vz, U_vy_vz, T) {
    const x_new = T*v_x + x;
    const y_new = T*v_y + y;
    const z_new = T*v_z + z;
    const U_x_vx_new = T + U_x_vx;
    const U_x_vy_new = T*U_vx_vy + U_x_vy;
    const U_x_vz_new = T*U_vx_vz + U_x_vz;
    const U_y_vy_new = T + U_y_vy;
    const U_y_vz_new = T*U_vy_vz + U_y_vz;
    const U_z_vz_new = T + U_z_vz;
    return [x_new, y_new, z_new, U_x_vx_new, U_x_vy_new, U_x_vz_new, U_y_vy_new, U_y_vz_new, U_z_vz_new];
}

function add_noise(D_x, U_x_y, U_x_z, U_x_vx, U_x_vy, U_x_vz, D_y, U_y_z,
        U_y_vx, U_y_vy, U_y_vz, D_z, U_z_vx, U_z_vy, U_z_vz, D_vx, U_vx_vy,
        U_vx_vz, D_vy, U_vy_vz, D_vz, g_x, g_y, g_z, g_vx, g_vy, g_vz) {
    const share_vz = g_vz;
    const D_vz_new = D_vz + g_vz*share_vz;
    const inverse_vz = 1/(D_vz_new + 1e-300);
    const gain_vz = inverse_vz*share_vz;
    const weight_vz = inverse_vz*(D_vz + 1e-300);
    const g_x_vz = -U_x_vz*g_vz + g_x;
    const U_x_vz_new = U_x_vz + g_x_vz*gain_vz;
    const g_y_vz = -U_y_vz*g_vz + g_y;
    const U_y_vz_new = U_y_vz + g_y_vz*gain_vz;
    const g_z_vz = -U_z_vz*g_vz + g_z;
    const U_z_vz_new = U_z_vz + g_z_vz*gain_vz;
    const g_vx_vz = -U_vx_vz*g_vz + g_vx;
    const U_vx_vz_new = U_vx_vz + g_vx_vz*gain_vz;
    const g_vy_vz = -U_vy_vz*g_vz + g_vy;
    const U_vy_vz_new = U_vy_vz + g_vy_vz*gain_vz;
    const share_vy = g_vy_vz*weight_vz;
    const D_vy_new = D_vy + g_vy_vz*share_vy;
    const inverse_vy = 1/(D_vy_new + 1e-300);
    const gain_vy = inverse_vy*share_vy;
    const weight_vy = inverse_vy*weight_vz*(D_vy + 1e-300);
    const g_x_vy = -U_x_vy*g_vy_vz + g_x_vz;
    const U_x_vy_new = U_x_vy + g_x_vy*gain_vy;
    const g_y_vy = -U_y_vy*g_vy_vz + g_y_vz;
    const U_y_vy_new = U_y_vy + g_y_vy*gain_vy;
    const g_z_vy = -U_z_vy*g_vy_vz + g_z_vz;
    const U_z_vy_new = U_z_vy + g_z_vy*gain_vy;
    const g_vx_vy = -U_vx_vy*g_vy_vz + g_vx_vz;
    const U_vx_vy_new = U_vx_vy + g_vx_vy*gain_vy;
    const share_vx = g_vx_vy*weight_vy;
    const D_vx_new = D_vx + g_vx_vy*share_vx;
    const inverse_vx = 1/(D_vx_new + 1e-300);
    const gain_vx = inverse_vx*share_vx;
    const weight_vx = inverse_vx*weight_vy*(D_vx + 1e-300);
    const g_x_vx = -U_x_vx*g_vx_vy + g_x_vy;
    const U_x_vx_new = U_x_vx + g_x_vx*gain_vx;
    const g_y_vx = -U_y_vx*g_vx_vy + g_y_vy;
    const U_y_vx_new = U_y_vx + g_y_vx*gain_vx;
    const g_z_vx = -U_z_vx*g_vx_vy + g_z_vy;
    const U_z_vx_new = U_z_vx + g_z_vx*gain_vx;
    const share_z = g_z_vx*weight_vx;
    const D_z_new = D_z + g_z_vx*share_z;
    const inverse_z = 1/(D_z_new + 1e-300);
    const gain_z = inverse_z*share_z;
    const weight_z = inverse_z*weight_vx*(D_z + 1e-300);
    const g_x_z = -U_x_z*g_z_vx + g_x_vx;
    const U_x_z_new = U_x_z + g_x_z*gain_z;
    const g_y_z = -U_y_z*g_z_vx + g_y_vx;
    const U_y_z_new = U_y_z + g_y_z*gain_z;
    const share_y = g_y_z*weight_z;
    const D_y_new = D_y + g_y_z*share_y;
    const inverse_y = 1/(D_y_new + 1e-300);
    const gain_y = inverse_y*share_y;
    const weight_y = inverse_y*weight_z*(D_y + 1e-300);
    const g_x_y = -U_x_y*g_y_z + g_x_z;
    const U_x_y_new = U_x_y + g_x_y*gain_y;
    const share_x = g_x_y*weight_y;
    const D_x_new = D_x + g_x_y*share_x;
    return [D_x_new, U_x_y_new, U_x_z_new, U_x_vx_new, U_x_vy_new, U_x_vz_new, D_y_new, U_y_z_new, U_y_vx_new, U_y_vy_new, U_y_vz_new, D_z_new, U_z_vx_new, U_z_vy_new, U_z_vz_new, D_vx_new, U_vx_vy_new, U_vx_vz_new, D_vy_new, U_vy_vz_new, D_vz_new];
}

function linearize(x, y, z, v_x, v_y, v_z, measurement, s_x, s_y, s_z,
        doppler_per_speed) {
    const d_x = s_x - x;
    const d_y = s_y - y;
    const d_z = s_z - z;
    const inverse_range = 1/Math.sqrt(d_x*d_x + d_y*d_y + d_z*d_z);
    const t0 = d_x*v_x + d_y*v_y + d_z*v_z;
    const t1 = doppler_per_speed*inverse_range;
    const shift = t0*t1;
    const t2 = (inverse_range*inverse_range)*t0;
    const h_x = t1*(d_x*t2 - v_x);
    const h_y = t1*(d_y*t2 - v_y);
    const h_z = t1*(d_z*t2 - v_z);
    const h_vx = d_x*t1;
    const h_vy = d_y*t1;
    const h_vz = d_z*t1;
    const innovation = measurement - shift;
    return [innovation, h_x, h_y, h_z, h_vx, h_vy, h_vz];
}

function project(D_x, U_x_y, U_x_z, U_x_vx, U_x_vy, U_x_vz, D_y, U_y_z, U_y_vx,
        U_y_vy, U_y_vz, D_z, U_z_vx, U_z_vy, U_z_vz, D_vx, U_vx_vy, U_vx_vz,
        D_vy, U_vy_vz, D_vz, h_x, h_y, h_z, h_vx, h_vy, h_vz) {
    const f_x = h_x;
    const f_y = U_x_y*h_x + h_y;
    const f_z = U_x_z*h_x + U_y_z*h_y + h_z;
    const f_vx = U_x_vx*h_x + U_y_vx*h_y + U_z_vx*h_z + h_vx;
    const f_vy = U_vx_vy*h_vx + U_x_vy*h_x + U_y_vy*h_y + U_z_vy*h_z + h_vy;
    const f_vz = U_vx_vz*h_vx + U_vy_vz*h_vy + U_x_vz*h_x + U_y_vz*h_y + U_z_vz*h_z + h_vz;
    const b_x = D_x*f_x;
    const b_y = D_y*f_y;
    const b_z = D_z*f_z;
    const b_vx = D_vx*f_vx;
    const b_vy = D_vy*f_vy;
    const b_vz = D_vz*f_vz;
    return [f_x, f_y, f_z, f_vx, f_vy, f_vz, b_x, b_y, b_z, b_vx, b_vy, b_vz];
}

function update(D_x, U_x_y, U_x_z, U_x_vx, U_x_vy, U_x_vz, D_y, U_y_z, U_y_vx,
        U_y_vy, U_y_vz, D_z, U_z_vx, U_z_vy, U_z_vz, D_vx, U_vx_vy, U_vx_vz,
        D_vy, U_vy_vz, D_vz, c_x, c_y, c_z, c_vx, c_vy, c_vz, nis, innovation,
        h_x, h_y, h_z, h_vx, h_vy, h_vz, variance) {
    const f_x = h_x;
    const f_y = U_x_y*h_x + h_y;
    const f_z = U_x_z*h_x + U_y_z*h_y + h_z;
    const f_vx = U_x_vx*h_x + U_y_vx*h_y + U_z_vx*h_z + h_vx;
    const f_vy = U_vx_vy*h_vx + U_x_vy*h_x + U_y_vy*h_y + U_z_vy*h_z + h_vy;
    const f_vz = U_vx_vz*h_vx + U_vy_vz*h_vy + U_x_vz*h_x + U_y_vz*h_y + U_z_vz*h_z + h_vz;
    const b_x = D_x*f_x;
    const b_y = D_y*f_y;
    const b_z = D_z*f_z;
    const b_vx = D_vx*f_vx;
    const b_vy = D_vy*f_vy;
    const b_vz = D_vz*f_vz;
    const a_x = b_x*f_x + variance;
    const a_y = a_x + b_y*f_y;
    const a_z = a_y + b_z*f_z;
    const a_vx = a_z + b_vx*f_vx;
    const a_vy = a_vx + b_vy*f_vy;
    const a_vz = a_vy + b_vz*f_vz;
    const inverse_x = 1/a_x;
    const inverse_y = 1/a_y;
    const inverse_z = 1/a_z;
    const inverse_vx = 1/a_vx;
    const inverse_vy = 1/a_vy;
    const inverse_vz = 1/a_vz;
    const D_x_new = D_x*inverse_x*variance;
    const D_y_new = D_y*a_x*inverse_y;
    const lost_y = f_y*inverse_x;
    const U_x_y_new = U_x_y - b_x*lost_y;
    const w_x_y = U_x_y*b_y + b_x;
    const D_z_new = D_z*a_y*inverse_z;
    const lost_z = f_z*inverse_y;
    const U_x_z_new = U_x_z - lost_z*w_x_y;
    const w_x_z = U_x_z*b_z + w_x_y;
    const U_y_z_new = U_y_z - b_y*lost_z;
    const w_y_z = U_y_z*b_z + b_y;
    const D_vx_new = D_vx*a_z*inverse_vx;
    const lost_vx = f_vx*inverse_z;
    const U_x_vx_new = U_x_vx - lost_vx*w_x_z;
    const w_x_vx = U_x_vx*b_vx + w_x_z;
    const U_y_vx_new = U_y_vx - lost_vx*w_y_z;
    const w_y_vx = U_y_vx*b_vx + w_y_z;
    const U_z_vx_new = U_z_vx - b_z*lost_vx;
    const w_z_vx = U_z_vx*b_vx + b_z;
    const D_vy_new = D_vy*a_vx*inverse_vy;
    const lost_vy = f_vy*inverse_vx;
    const U_x_vy_new = U_x_vy - lost_vy*w_x_vx;
    const w_x_vy = U_x_vy*b_vy + w_x_vx;
    const U_y_vy_new = U_y_vy - lost_vy*w_y_vx;
    const w_y_vy = U_y_vy*b_vy + w_y_vx;
    const U_z_vy_new = U_z_vy - lost_vy*w_z_vx;
    const w_z_vy = U_z_vy*b_vy + w_z_vx;
    const U_vx_vy_new = U_vx_vy - b_vx*lost_vy;
    const w_vx_vy = U_vx_vy*b_vy + b_vx;
    const D_vz_new = D_vz*a_vy*inverse_vz;
    const lost_vz = f_vz*inverse_vy;
    const U_x_vz_new = U_x_vz - lost_vz*w_x_vy;
    const w_x_vz = U_x_vz*b_vz + w_x_vy;
    const U_y_vz_new = U_y_vz - lost_vz*w_y_vy;
    const w_y_vz = U_y_vz*b_vz + w_y_vy;
    const U_z_vz_new = U_z_vz - lost_vz*w_z_vy;
    const w_z_vz = U_z_vz*b_vz + w_z_vy;
    const U_vx_vz_new = U_vx_vz - lost_vz*w_vx_vy;
    const w_vx_vz = U_vx_vz*b_vz + w_vx_vy;
    const U_vy_vz_new = U_vy_vz - b_vy*lost_vz;
    const w_vy_vz = U_vy_vz*b_vz + b_vy;
    const e = -c_vx*h_vx - c_vy*h_vy - c_vz*h_vz - c_x*h_x - c_y*h_y - c_z*h_z + innovation;
    const weighted = e*inverse_vz;
    const c_x_new = c_x + w_x_vz*weighted;
    const c_y_new = c_y + w_y_vz*weighted;
    const c_z_new = c_z + w_z_vz*weighted;
    const c_vx_new = c_vx + w_vx_vz*weighted;
    const c_vy_new = c_vy + w_vy_vz*weighted;
    const c_vz_new = b_vz*weighted + c_vz;
    const nis_new = e*weighted + nis;
    return [D_x_new, U_x_y_new, U_x_z_new, U_x_vx_new, U_x_vy_new, U_x_vz_new, D_y_new, U_y_z_new, U_y_vx_new, U_y_vy_new, U_y_vz_new, D_z_new, U_z_vx_new, U_z_vy_new, U_z_vz_new, D_vx_new, U_vx_vy_new, U_vx_vz_new, D_vy_new, U_vy_vz_new, D_vz_new, c_x_new, c_y_new, c_z_new, c_vx_new, c_vy_new, c_vz_new, nis_new];
}

function covariance(D_x, U_x_y, U_x_z, U_x_vx, U_x_vy, U_x_vz, D_y, U_y_z,
        U_y_vx, U_y_vy, U_y_vz, D_z, U_z_vx, U_z_vy, U_z_vz, D_vx, U_vx_vy,
        U_vx_vz, D_vy, U_vy_vz, D_vz) {
    const DU_x_y = D_y*U_x_y;
    const DU_x_z = D_z*U_x_z;
    const DU_x_vx = D_vx*U_x_vx;
    const DU_x_vy = D_vy*U_x_vy;
    const DU_x_vz = D_vz*U_x_vz;
    const DU_y_z = D_z*U_y_z;
    const DU_y_vx = D_vx*U_y_vx;
    const DU_y_vy = D_vy*U_y_vy;
    const DU_y_vz = D_vz*U_y_vz;
    const DU_z_vx = D_vx*U_z_vx;
    const DU_z_vy = D_vy*U_z_vy;
    const DU_z_vz = D_vz*U_z_vz;
    const DU_vx_vy = D_vy*U_vx_vy;
    const DU_vx_vz = D_vz*U_vx_vz;
    const DU_vy_vz = D_vz*U_vy_vz;
    const p_x_x = DU_x_vx*U_x_vx + DU_x_vy*U_x_vy + DU_x_vz*U_x_vz + DU_x_y*U_x_y + DU_x_z*U_x_z + D_x;
    const p_x_y = DU_y_vx*U_x_vx + DU_y_vy*U_x_vy + DU_y_vz*U_x_vz + DU_y_z*U_x_z + D_y*U_x_y;
    const p_x_z = DU_z_vx*U_x_vx + DU_z_vy*U_x_vy + DU_z_vz*U_x_vz + D_z*U_x_z;
    const p_x_vx = DU_vx_vy*U_x_vy + DU_vx_vz*U_x_vz + D_vx*U_x_vx;
    const p_x_vy = DU_vy_vz*U_x_vz + D_vy*U_x_vy;
    const p_x_vz = D_vz*U_x_vz;
    const p_y_y = DU_y_vx*U_y_vx + DU_y_vy*U_y_vy + DU_y_vz*U_y_vz + DU_y_z*U_y_z + D_y;
    const p_y_z = DU_z_vx*U_y_vx + DU_z_vy*U_y_vy + DU_z_vz*U_y_vz + D_z*U_y_z;
    const p_y_vx = DU_vx_vy*U_y_vy + DU_vx_vz*U_y_vz + D_vx*U_y_vx;
    const p_y_vy = DU_vy_vz*U_y_vz + D_vy*U_y_vy;
    const p_y_vz = D_vz*U_y_vz;
    const p_z_z = DU_z_vx*U_z_vx + DU_z_vy*U_z_vy + DU_z_vz*U_z_vz + D_z;
    const p_z_vx = DU_vx_vy*U_z_vy + DU_vx_vz*U_z_vz + D_vx*U_z_vx;
    const p_z_vy = DU_vy_vz*U_z_vz + D_vy*U_z_vy;
    const p_z_vz = D_vz*U_z_vz;
    const p_vx_vx = DU_vx_vy*U_vx_vy + DU_vx_vz*U_vx_vz + D_vx;
    const p_vx_vy = DU_vy_vz*U_vx_vz + D_vy*U_vx_vy;
    const p_vx_vz = D_vz*U_vx_vz;
    const p_vy_vy = DU_vy_vz*U_vy_vz + D_vy;
    const p_vy_vz = D_vz*U_vy_vz;
    const p_vz_vz = D_vz;
    return [p_x_x, p_x_y, p_x_z, p_x_vx, p_x_vy, p_x_vz, p_y_y, p_y_z, p_y_vx, p_y_vy, p_y_vz, p_z_z, p_z_vx, p_z_vy, p_z_vz, p_vx_vx, p_vx_vy, p_vx_vz, p_vy_vy, p_vy_vz, p_vz_vz];
}

return { doppler_shift, doppler_shift_and_gradient, ring_family_state, predict, add_noise, linearize, project, update, covariance };
})();
