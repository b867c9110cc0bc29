/* Track a target by the Doppler shifts of N sensors, and decide when to stop.
 *
 * Printed by `make kernels` with SymPy 1.14.0. Do not edit: change
 * dopplerlib/derive and print again.
 */
#include "doppler_tracker.h"

#include <float.h>
#include <math.h>

#ifdef __FAST_MATH__
#error "-ffast-math does away with NaN, which is a missing measurement"
#endif

/* DOPPLER_NOTHING is added to both sides of a fraction that would be 0 / 0
 * where nothing is uncertain, and changes no other. */
#ifdef DOPPLER_FLOAT
#define DOPPLER_SQRT sqrtf
#define DOPPLER_EPSILON FLT_EPSILON
#define DOPPLER_LARGEST FLT_MAX
#define DOPPLER_NOTHING 1e-36F
#else
#define DOPPLER_SQRT sqrt
#define DOPPLER_EPSILON DBL_EPSILON
#define DOPPLER_LARGEST DBL_MAX
#define DOPPLER_NOTHING 1e-300
#endif

/* Time update but for its noise: x = F x, U = F U (Table 1). The rest stays. */
static void predict(doppler_real *state, doppler_real *factors, doppler_real T)
{
    const doppler_real x = state[0];
    const doppler_real y = state[1];
    const doppler_real z = state[2];
    const doppler_real v_x = state[3];
    const doppler_real v_y = state[4];
    const doppler_real v_z = state[5];
    const doppler_real U_x_vx = factors[3];
    const doppler_real U_x_vy = factors[4];
    const doppler_real U_x_vz = factors[5];
    const doppler_real U_y_vy = factors[9];
    const doppler_real U_y_vz = factors[10];
    const doppler_real U_z_vz = factors[14];
    const doppler_real U_vx_vy = factors[16];
    const doppler_real U_vx_vz = factors[17];
    const doppler_real U_vy_vz = factors[19];
    /* state */
    const doppler_real x_new = T*v_x + x;
    const doppler_real y_new = T*v_y + y;
    const doppler_real z_new = T*v_z + z;
    /* factor U */
    const doppler_real U_x_vx_new = T + U_x_vx;
    const doppler_real U_x_vy_new = T*U_vx_vy + U_x_vy;
    const doppler_real U_x_vz_new = T*U_vx_vz + U_x_vz;
    const doppler_real U_y_vy_new = T + U_y_vy;
    const doppler_real U_y_vz_new = T*U_vy_vz + U_y_vz;
    const doppler_real U_z_vz_new = T + U_z_vz;
    state[0] = x_new;
    state[1] = y_new;
    state[2] = z_new;
    factors[3] = U_x_vx_new;
    factors[4] = U_x_vy_new;
    factors[5] = U_x_vz_new;
    factors[9] = U_y_vy_new;
    factors[10] = U_y_vz_new;
    factors[14] = U_z_vz_new;
}

/* Displacement and speed that an acceleration sigma_a adds in T (Eq 9). */
static void gains(doppler_real *gain, doppler_real T, doppler_real sigma_a)
{
    /* half the square of T */
    const doppler_real half = ((doppler_real)1/(doppler_real)2)*(T*T);
    /* gains */
    const doppler_real g_p = half*sigma_a;
    const doppler_real g_v = T*sigma_a;
    gain[0] = g_p;
    gain[1] = g_v;
}

/* Factors of P + g g', the noise of the time update (Table 1, Eq 9). */
static void add_noise(doppler_real *factors, const doppler_real *noise,
        doppler_real nothing)
{
    const doppler_real D_x = factors[0];
    const doppler_real U_x_y = factors[1];
    const doppler_real U_x_z = factors[2];
    const doppler_real U_x_vx = factors[3];
    const doppler_real U_x_vy = factors[4];
    const doppler_real U_x_vz = factors[5];
    const doppler_real D_y = factors[6];
    const doppler_real U_y_z = factors[7];
    const doppler_real U_y_vx = factors[8];
    const doppler_real U_y_vy = factors[9];
    const doppler_real U_y_vz = factors[10];
    const doppler_real D_z = factors[11];
    const doppler_real U_z_vx = factors[12];
    const doppler_real U_z_vy = factors[13];
    const doppler_real U_z_vz = factors[14];
    const doppler_real D_vx = factors[15];
    const doppler_real U_vx_vy = factors[16];
    const doppler_real U_vx_vz = factors[17];
    const doppler_real D_vy = factors[18];
    const doppler_real U_vy_vz = factors[19];
    const doppler_real D_vz = factors[20];
    const doppler_real g_x = noise[0];
    const doppler_real g_y = noise[1];
    const doppler_real g_z = noise[2];
    const doppler_real g_vx = noise[3];
    const doppler_real g_vy = noise[4];
    const doppler_real g_vz = noise[5];
    /* from the last axis to the first */
    const doppler_real share_vz = g_vz;
    const doppler_real D_vz_new = D_vz + g_vz*share_vz;
    const doppler_real inverse_vz = 1/(D_vz_new + nothing);
    const doppler_real gain_vz = inverse_vz*share_vz;
    const doppler_real weight_vz = inverse_vz*(D_vz + nothing);
    const doppler_real g_x_vz = -U_x_vz*g_vz + g_x;
    const doppler_real U_x_vz_new = U_x_vz + g_x_vz*gain_vz;
    const doppler_real g_y_vz = -U_y_vz*g_vz + g_y;
    const doppler_real U_y_vz_new = U_y_vz + g_y_vz*gain_vz;
    const doppler_real g_z_vz = -U_z_vz*g_vz + g_z;
    const doppler_real U_z_vz_new = U_z_vz + g_z_vz*gain_vz;
    const doppler_real g_vx_vz = -U_vx_vz*g_vz + g_vx;
    const doppler_real U_vx_vz_new = U_vx_vz + g_vx_vz*gain_vz;
    const doppler_real g_vy_vz = -U_vy_vz*g_vz + g_vy;
    const doppler_real U_vy_vz_new = U_vy_vz + g_vy_vz*gain_vz;
    const doppler_real share_vy = g_vy_vz*weight_vz;
    const doppler_real D_vy_new = D_vy + g_vy_vz*share_vy;
    const doppler_real inverse_vy = 1/(D_vy_new + nothing);
    const doppler_real gain_vy = inverse_vy*share_vy;
    const doppler_real weight_vy = inverse_vy*weight_vz*(D_vy + nothing);
    const doppler_real g_x_vy = -U_x_vy*g_vy_vz + g_x_vz;
    const doppler_real U_x_vy_new = U_x_vy + g_x_vy*gain_vy;
    const doppler_real g_y_vy = -U_y_vy*g_vy_vz + g_y_vz;
    const doppler_real U_y_vy_new = U_y_vy + g_y_vy*gain_vy;
    const doppler_real g_z_vy = -U_z_vy*g_vy_vz + g_z_vz;
    const doppler_real U_z_vy_new = U_z_vy + g_z_vy*gain_vy;
    const doppler_real g_vx_vy = -U_vx_vy*g_vy_vz + g_vx_vz;
    const doppler_real U_vx_vy_new = U_vx_vy + g_vx_vy*gain_vy;
    const doppler_real share_vx = g_vx_vy*weight_vy;
    const doppler_real D_vx_new = D_vx + g_vx_vy*share_vx;
    const doppler_real inverse_vx = 1/(D_vx_new + nothing);
    const doppler_real gain_vx = inverse_vx*share_vx;
    const doppler_real weight_vx = inverse_vx*weight_vy*(D_vx + nothing);
    const doppler_real g_x_vx = -U_x_vx*g_vx_vy + g_x_vy;
    const doppler_real U_x_vx_new = U_x_vx + g_x_vx*gain_vx;
    const doppler_real g_y_vx = -U_y_vx*g_vx_vy + g_y_vy;
    const doppler_real U_y_vx_new = U_y_vx + g_y_vx*gain_vx;
    const doppler_real g_z_vx = -U_z_vx*g_vx_vy + g_z_vy;
    const doppler_real U_z_vx_new = U_z_vx + g_z_vx*gain_vx;
    const doppler_real share_z = g_z_vx*weight_vx;
    const doppler_real D_z_new = D_z + g_z_vx*share_z;
    const doppler_real inverse_z = 1/(D_z_new + nothing);
    const doppler_real gain_z = inverse_z*share_z;
    const doppler_real weight_z = inverse_z*weight_vx*(D_z + nothing);
    const doppler_real g_x_z = -U_x_z*g_z_vx + g_x_vx;
    const doppler_real U_x_z_new = U_x_z + g_x_z*gain_z;
    const doppler_real g_y_z = -U_y_z*g_z_vx + g_y_vx;
    const doppler_real U_y_z_new = U_y_z + g_y_z*gain_z;
    const doppler_real share_y = g_y_z*weight_z;
    const doppler_real D_y_new = D_y + g_y_z*share_y;
    const doppler_real inverse_y = 1/(D_y_new + nothing);
    const doppler_real gain_y = inverse_y*share_y;
    const doppler_real weight_y = inverse_y*weight_z*(D_y + nothing);
    const doppler_real g_x_y = -U_x_y*g_y_z + g_x_z;
    const doppler_real U_x_y_new = U_x_y + g_x_y*gain_y;
    const doppler_real share_x = g_x_y*weight_y;
    const doppler_real D_x_new = D_x + g_x_y*share_x;
    factors[0] = D_x_new;
    factors[1] = U_x_y_new;
    factors[2] = U_x_z_new;
    factors[3] = U_x_vx_new;
    factors[4] = U_x_vy_new;
    factors[5] = U_x_vz_new;
    factors[6] = D_y_new;
    factors[7] = U_y_z_new;
    factors[8] = U_y_vx_new;
    factors[9] = U_y_vy_new;
    factors[10] = U_y_vz_new;
    factors[11] = D_z_new;
    factors[12] = U_z_vx_new;
    factors[13] = U_z_vy_new;
    factors[14] = U_z_vz_new;
    factors[15] = D_vx_new;
    factors[16] = U_vx_vy_new;
    factors[17] = U_vx_vz_new;
    factors[18] = D_vy_new;
    factors[19] = U_vy_vz_new;
    factors[20] = D_vz_new;
}

/* Innovation of one sensor at the predicted state, and its gradient (Eqs 6, 7). */
static void linearize(const doppler_real *state, const doppler_real *sensor,
        doppler_real *linear, doppler_real measurement, doppler_real
        doppler_per_speed)
{
    const doppler_real x = state[0];
    const doppler_real y = state[1];
    const doppler_real z = state[2];
    const doppler_real v_x = state[3];
    const doppler_real v_y = state[4];
    const doppler_real v_z = state[5];
    const doppler_real s_x = sensor[0];
    const doppler_real s_y = sensor[1];
    const doppler_real s_z = sensor[2];
    /* line of sight and inverse range */
    const doppler_real d_x = s_x - x;
    const doppler_real d_y = s_y - y;
    const doppler_real d_z = s_z - z;
    const doppler_real inverse_range = 1/DOPPLER_SQRT(d_x*d_x + d_y*d_y + d_z*d_z);
    /* Doppler shift, Eq 6, and its gradient, Eq 7 */
    const doppler_real t0 = d_x*v_x + d_y*v_y + d_z*v_z;
    const doppler_real t1 = doppler_per_speed*inverse_range;
    const doppler_real shift = t0*t1;
    const doppler_real t2 = (inverse_range*inverse_range)*t0;
    const doppler_real h_x = t1*(d_x*t2 - v_x);
    const doppler_real h_y = t1*(d_y*t2 - v_y);
    const doppler_real h_z = t1*(d_z*t2 - v_z);
    const doppler_real h_vx = d_x*t1;
    const doppler_real h_vy = d_y*t1;
    const doppler_real h_vz = d_z*t1;
    /* innovation */
    const doppler_real innovation = measurement - shift;
    linear[0] = innovation;
    linear[1] = h_x;
    linear[2] = h_y;
    linear[3] = h_z;
    linear[4] = h_vx;
    linear[5] = h_vy;
    linear[6] = h_vz;
}

/* Measurement update by one linearized sensor (Table 1, Eq 14). */
static void update(doppler_real *factors, doppler_real *correction, const
        doppler_real *linear, doppler_real variance)
{
    const doppler_real D_x = factors[0];
    const doppler_real U_x_y = factors[1];
    const doppler_real U_x_z = factors[2];
    const doppler_real U_x_vx = factors[3];
    const doppler_real U_x_vy = factors[4];
    const doppler_real U_x_vz = factors[5];
    const doppler_real D_y = factors[6];
    const doppler_real U_y_z = factors[7];
    const doppler_real U_y_vx = factors[8];
    const doppler_real U_y_vy = factors[9];
    const doppler_real U_y_vz = factors[10];
    const doppler_real D_z = factors[11];
    const doppler_real U_z_vx = factors[12];
    const doppler_real U_z_vy = factors[13];
    const doppler_real U_z_vz = factors[14];
    const doppler_real D_vx = factors[15];
    const doppler_real U_vx_vy = factors[16];
    const doppler_real U_vx_vz = factors[17];
    const doppler_real D_vy = factors[18];
    const doppler_real U_vy_vz = factors[19];
    const doppler_real D_vz = factors[20];
    const doppler_real c_x = correction[0];
    const doppler_real c_y = correction[1];
    const doppler_real c_z = correction[2];
    const doppler_real c_vx = correction[3];
    const doppler_real c_vy = correction[4];
    const doppler_real c_vz = correction[5];
    const doppler_real nis = correction[6];
    const doppler_real innovation = linear[0];
    const doppler_real h_x = linear[1];
    const doppler_real h_y = linear[2];
    const doppler_real h_z = linear[3];
    const doppler_real h_vx = linear[4];
    const doppler_real h_vy = linear[5];
    const doppler_real h_vz = linear[6];
    /* f = U' h, b = D f */
    const doppler_real f_x = h_x;
    const doppler_real f_y = U_x_y*h_x + h_y;
    const doppler_real f_z = U_x_z*h_x + U_y_z*h_y + h_z;
    const doppler_real f_vx = U_x_vx*h_x + U_y_vx*h_y + U_z_vx*h_z + h_vx;
    const doppler_real f_vy = U_vx_vy*h_vx + U_x_vy*h_x + U_y_vy*h_y + U_z_vy*h_z + h_vy;
    const doppler_real f_vz = U_vx_vz*h_vx + U_vy_vz*h_vy + U_x_vz*h_x + U_y_vz*h_y + U_z_vz*h_z + h_vz;
    const doppler_real b_x = D_x*f_x;
    const doppler_real b_y = D_y*f_y;
    const doppler_real b_z = D_z*f_z;
    const doppler_real b_vx = D_vx*f_vx;
    const doppler_real b_vy = D_vy*f_vy;
    const doppler_real b_vz = D_vz*f_vz;
    /* the variance h' P h + r of the innovation, axis by axis */
    const doppler_real a_x = b_x*f_x + variance;
    const doppler_real a_y = a_x + b_y*f_y;
    const doppler_real a_z = a_y + b_z*f_z;
    const doppler_real a_vx = a_z + b_vx*f_vx;
    const doppler_real a_vy = a_vx + b_vy*f_vy;
    const doppler_real a_vz = a_vy + b_vz*f_vz;
    const doppler_real inverse_x = 1/a_x;
    const doppler_real inverse_y = 1/a_y;
    const doppler_real inverse_z = 1/a_z;
    const doppler_real inverse_vx = 1/a_vx;
    const doppler_real inverse_vy = 1/a_vy;
    const doppler_real inverse_vz = 1/a_vz;
    /* factors, and P h = U b on the way */
    const doppler_real D_x_new = D_x*inverse_x*variance;
    const doppler_real D_y_new = D_y*a_x*inverse_y;
    const doppler_real lost_y = f_y*inverse_x;
    const doppler_real U_x_y_new = U_x_y - b_x*lost_y;
    const doppler_real w_x_y = U_x_y*b_y + b_x;
    const doppler_real D_z_new = D_z*a_y*inverse_z;
    const doppler_real lost_z = f_z*inverse_y;
    const doppler_real U_x_z_new = U_x_z - lost_z*w_x_y;
    const doppler_real w_x_z = U_x_z*b_z + w_x_y;
    const doppler_real U_y_z_new = U_y_z - b_y*lost_z;
    const doppler_real w_y_z = U_y_z*b_z + b_y;
    const doppler_real D_vx_new = D_vx*a_z*inverse_vx;
    const doppler_real lost_vx = f_vx*inverse_z;
    const doppler_real U_x_vx_new = U_x_vx - lost_vx*w_x_z;
    const doppler_real w_x_vx = U_x_vx*b_vx + w_x_z;
    const doppler_real U_y_vx_new = U_y_vx - lost_vx*w_y_z;
    const doppler_real w_y_vx = U_y_vx*b_vx + w_y_z;
    const doppler_real U_z_vx_new = U_z_vx - b_z*lost_vx;
    const doppler_real w_z_vx = U_z_vx*b_vx + b_z;
    const doppler_real D_vy_new = D_vy*a_vx*inverse_vy;
    const doppler_real lost_vy = f_vy*inverse_vx;
    const doppler_real U_x_vy_new = U_x_vy - lost_vy*w_x_vx;
    const doppler_real w_x_vy = U_x_vy*b_vy + w_x_vx;
    const doppler_real U_y_vy_new = U_y_vy - lost_vy*w_y_vx;
    const doppler_real w_y_vy = U_y_vy*b_vy + w_y_vx;
    const doppler_real U_z_vy_new = U_z_vy - lost_vy*w_z_vx;
    const doppler_real w_z_vy = U_z_vy*b_vy + w_z_vx;
    const doppler_real U_vx_vy_new = U_vx_vy - b_vx*lost_vy;
    const doppler_real w_vx_vy = U_vx_vy*b_vy + b_vx;
    const doppler_real D_vz_new = D_vz*a_vy*inverse_vz;
    const doppler_real lost_vz = f_vz*inverse_vy;
    const doppler_real U_x_vz_new = U_x_vz - lost_vz*w_x_vy;
    const doppler_real w_x_vz = U_x_vz*b_vz + w_x_vy;
    const doppler_real U_y_vz_new = U_y_vz - lost_vz*w_y_vy;
    const doppler_real w_y_vz = U_y_vz*b_vz + w_y_vy;
    const doppler_real U_z_vz_new = U_z_vz - lost_vz*w_z_vy;
    const doppler_real w_z_vz = U_z_vz*b_vz + w_z_vy;
    const doppler_real U_vx_vz_new = U_vx_vz - lost_vz*w_vx_vy;
    const doppler_real w_vx_vz = U_vx_vz*b_vz + w_vx_vy;
    const doppler_real U_vy_vz_new = U_vy_vz - b_vy*lost_vz;
    const doppler_real w_vy_vz = U_vy_vz*b_vz + b_vy;
    /* innovation e left by the sensors before, correction P h e / a, NIS */
    const doppler_real e = -c_vx*h_vx - c_vy*h_vy - c_vz*h_vz - c_x*h_x - c_y*h_y - c_z*h_z + innovation;
    const doppler_real weighted = e*inverse_vz;
    const doppler_real c_x_new = c_x + w_x_vz*weighted;
    const doppler_real c_y_new = c_y + w_y_vz*weighted;
    const doppler_real c_z_new = c_z + w_z_vz*weighted;
    const doppler_real c_vx_new = c_vx + w_vx_vz*weighted;
    const doppler_real c_vy_new = c_vy + w_vy_vz*weighted;
    const doppler_real c_vz_new = b_vz*weighted + c_vz;
    const doppler_real nis_new = e*weighted + nis;
    factors[0] = D_x_new;
    factors[1] = U_x_y_new;
    factors[2] = U_x_z_new;
    factors[3] = U_x_vx_new;
    factors[4] = U_x_vy_new;
    factors[5] = U_x_vz_new;
    factors[6] = D_y_new;
    factors[7] = U_y_z_new;
    factors[8] = U_y_vx_new;
    factors[9] = U_y_vy_new;
    factors[10] = U_y_vz_new;
    factors[11] = D_z_new;
    factors[12] = U_z_vx_new;
    factors[13] = U_z_vy_new;
    factors[14] = U_z_vz_new;
    factors[15] = D_vx_new;
    factors[16] = U_vx_vy_new;
    factors[17] = U_vx_vz_new;
    factors[18] = D_vy_new;
    factors[19] = U_vy_vz_new;
    factors[20] = D_vz_new;
    correction[0] = c_x_new;
    correction[1] = c_y_new;
    correction[2] = c_z_new;
    correction[3] = c_vx_new;
    correction[4] = c_vy_new;
    correction[5] = c_vz_new;
    correction[6] = nis_new;
}

/* Corrected state (Table 1). */
static void correct(doppler_real *state, const doppler_real *correction)
{
    const doppler_real x = state[0];
    const doppler_real y = state[1];
    const doppler_real z = state[2];
    const doppler_real v_x = state[3];
    const doppler_real v_y = state[4];
    const doppler_real v_z = state[5];
    const doppler_real c_x = correction[0];
    const doppler_real c_y = correction[1];
    const doppler_real c_z = correction[2];
    const doppler_real c_vx = correction[3];
    const doppler_real c_vy = correction[4];
    const doppler_real c_vz = correction[5];
    /* state */
    const doppler_real x_new = c_x + x;
    const doppler_real y_new = c_y + y;
    const doppler_real z_new = c_z + z;
    const doppler_real v_x_new = c_vx + v_x;
    const doppler_real v_y_new = c_vy + v_y;
    const doppler_real v_z_new = c_vz + v_z;
    state[0] = x_new;
    state[1] = y_new;
    state[2] = z_new;
    state[3] = v_x_new;
    state[4] = v_y_new;
    state[5] = v_z_new;
}

/* P = U D U'. */
static void covariance(const doppler_real *factors, doppler_real *upper)
{
    const doppler_real D_x = factors[0];
    const doppler_real U_x_y = factors[1];
    const doppler_real U_x_z = factors[2];
    const doppler_real U_x_vx = factors[3];
    const doppler_real U_x_vy = factors[4];
    const doppler_real U_x_vz = factors[5];
    const doppler_real D_y = factors[6];
    const doppler_real U_y_z = factors[7];
    const doppler_real U_y_vx = factors[8];
    const doppler_real U_y_vy = factors[9];
    const doppler_real U_y_vz = factors[10];
    const doppler_real D_z = factors[11];
    const doppler_real U_z_vx = factors[12];
    const doppler_real U_z_vy = factors[13];
    const doppler_real U_z_vz = factors[14];
    const doppler_real D_vx = factors[15];
    const doppler_real U_vx_vy = factors[16];
    const doppler_real U_vx_vz = factors[17];
    const doppler_real D_vy = factors[18];
    const doppler_real U_vy_vz = factors[19];
    const doppler_real D_vz = factors[20];
    /* U D */
    const doppler_real DU_x_y = D_y*U_x_y;
    const doppler_real DU_x_z = D_z*U_x_z;
    const doppler_real DU_x_vx = D_vx*U_x_vx;
    const doppler_real DU_x_vy = D_vy*U_x_vy;
    const doppler_real DU_x_vz = D_vz*U_x_vz;
    const doppler_real DU_y_z = D_z*U_y_z;
    const doppler_real DU_y_vx = D_vx*U_y_vx;
    const doppler_real DU_y_vy = D_vy*U_y_vy;
    const doppler_real DU_y_vz = D_vz*U_y_vz;
    const doppler_real DU_z_vx = D_vx*U_z_vx;
    const doppler_real DU_z_vy = D_vy*U_z_vy;
    const doppler_real DU_z_vz = D_vz*U_z_vz;
    const doppler_real DU_vx_vy = D_vy*U_vx_vy;
    const doppler_real DU_vx_vz = D_vz*U_vx_vz;
    const doppler_real DU_vy_vz = D_vz*U_vy_vz;
    /* U D U' */
    const doppler_real p_x_x = DU_x_vx*U_x_vx + DU_x_vy*U_x_vy + DU_x_vz*U_x_vz + DU_x_y*U_x_y + DU_x_z*U_x_z + D_x;
    const doppler_real p_x_y = DU_y_vx*U_x_vx + DU_y_vy*U_x_vy + DU_y_vz*U_x_vz + DU_y_z*U_x_z + D_y*U_x_y;
    const doppler_real p_x_z = DU_z_vx*U_x_vx + DU_z_vy*U_x_vy + DU_z_vz*U_x_vz + D_z*U_x_z;
    const doppler_real p_x_vx = DU_vx_vy*U_x_vy + DU_vx_vz*U_x_vz + D_vx*U_x_vx;
    const doppler_real p_x_vy = DU_vy_vz*U_x_vz + D_vy*U_x_vy;
    const doppler_real p_x_vz = D_vz*U_x_vz;
    const doppler_real p_y_y = DU_y_vx*U_y_vx + DU_y_vy*U_y_vy + DU_y_vz*U_y_vz + DU_y_z*U_y_z + D_y;
    const doppler_real p_y_z = DU_z_vx*U_y_vx + DU_z_vy*U_y_vy + DU_z_vz*U_y_vz + D_z*U_y_z;
    const doppler_real p_y_vx = DU_vx_vy*U_y_vy + DU_vx_vz*U_y_vz + D_vx*U_y_vx;
    const doppler_real p_y_vy = DU_vy_vz*U_y_vz + D_vy*U_y_vy;
    const doppler_real p_y_vz = D_vz*U_y_vz;
    const doppler_real p_z_z = DU_z_vx*U_z_vx + DU_z_vy*U_z_vy + DU_z_vz*U_z_vz + D_z;
    const doppler_real p_z_vx = DU_vx_vy*U_z_vy + DU_vx_vz*U_z_vz + D_vx*U_z_vx;
    const doppler_real p_z_vy = DU_vy_vz*U_z_vz + D_vy*U_z_vy;
    const doppler_real p_z_vz = D_vz*U_z_vz;
    const doppler_real p_vx_vx = DU_vx_vy*U_vx_vy + DU_vx_vz*U_vx_vz + D_vx;
    const doppler_real p_vx_vy = DU_vy_vz*U_vx_vz + D_vy*U_vx_vy;
    const doppler_real p_vx_vz = D_vz*U_vx_vz;
    const doppler_real p_vy_vy = DU_vy_vz*U_vy_vz + D_vy;
    const doppler_real p_vy_vz = D_vz*U_vy_vz;
    const doppler_real p_vz_vz = D_vz;
    upper[0] = p_x_x;
    upper[1] = p_x_y;
    upper[2] = p_x_z;
    upper[3] = p_x_vx;
    upper[4] = p_x_vy;
    upper[5] = p_x_vz;
    upper[6] = p_y_y;
    upper[7] = p_y_z;
    upper[8] = p_y_vx;
    upper[9] = p_y_vy;
    upper[10] = p_y_vz;
    upper[11] = p_z_z;
    upper[12] = p_z_vx;
    upper[13] = p_z_vy;
    upper[14] = p_z_vz;
    upper[15] = p_vx_vx;
    upper[16] = p_vx_vy;
    upper[17] = p_vx_vz;
    upper[18] = p_vy_vy;
    upper[19] = p_vy_vz;
    upper[20] = p_vz_vz;
}

/* Distance to a point, its standard deviation, and its quantile. */
static void nearest(const doppler_real *state, const doppler_real *factors,
        const doppler_real *point, doppler_real *found, doppler_real quantile)
{
    const doppler_real x = state[0];
    const doppler_real y = state[1];
    const doppler_real z = state[2];
    const doppler_real D_x = factors[0];
    const doppler_real U_x_y = factors[1];
    const doppler_real U_x_z = factors[2];
    const doppler_real U_x_vx = factors[3];
    const doppler_real U_x_vy = factors[4];
    const doppler_real U_x_vz = factors[5];
    const doppler_real D_y = factors[6];
    const doppler_real U_y_z = factors[7];
    const doppler_real U_y_vx = factors[8];
    const doppler_real U_y_vy = factors[9];
    const doppler_real U_y_vz = factors[10];
    const doppler_real D_z = factors[11];
    const doppler_real U_z_vx = factors[12];
    const doppler_real U_z_vy = factors[13];
    const doppler_real U_z_vz = factors[14];
    const doppler_real D_vx = factors[15];
    const doppler_real D_vy = factors[18];
    const doppler_real D_vz = factors[20];
    const doppler_real q_x = point[0];
    const doppler_real q_y = point[1];
    const doppler_real q_z = point[2];
    /* away from the point */
    const doppler_real a_x = -q_x + x;
    const doppler_real a_y = -q_y + y;
    const doppler_real a_z = -q_z + z;
    /* distance */
    const doppler_real distance = DOPPLER_SQRT(a_x*a_x + a_y*a_y + a_z*a_z);
    /* direction */
    const doppler_real inverse = 1/distance;
    const doppler_real u_x = a_x*inverse;
    const doppler_real u_y = a_y*inverse;
    const doppler_real u_z = a_z*inverse;
    /* f = U' h, b = D f */
    const doppler_real f_x = u_x;
    const doppler_real f_y = U_x_y*u_x + u_y;
    const doppler_real f_z = U_x_z*u_x + U_y_z*u_y + u_z;
    const doppler_real f_vx = U_x_vx*u_x + U_y_vx*u_y + U_z_vx*u_z;
    const doppler_real f_vy = U_x_vy*u_x + U_y_vy*u_y + U_z_vy*u_z;
    const doppler_real f_vz = U_x_vz*u_x + U_y_vz*u_y + U_z_vz*u_z;
    const doppler_real b_x = D_x*f_x;
    const doppler_real b_y = D_y*f_y;
    const doppler_real b_z = D_z*f_z;
    const doppler_real b_vx = D_vx*f_vx;
    const doppler_real b_vy = D_vy*f_vy;
    const doppler_real b_vz = D_vz*f_vz;
    /* standard deviation */
    const doppler_real distance_std = DOPPLER_SQRT(b_vx*f_vx + b_vy*f_vy + b_vz*f_vz + b_x*f_x + b_y*f_y + b_z*f_z);
    /* quantile */
    const doppler_real nearest = distance + distance_std*quantile;
    found[0] = distance;
    found[1] = distance_std;
    found[2] = nearest;
}

/* Where row i, column j >= i of a matrix stands in its upper triangle. */
static int at(int i, int j)
{
    return i * (11 - i) / 2 + j;
}

void doppler_start(doppler_track *track, const doppler_real *x0,
                   const doppler_real *P0)
{
    doppler_real *U = track->factors;
    int i, j, k;

    for (i = 0; i < 6; i++)
        track->x[i] = x0[i];
    track->nis = (doppler_real)NAN;
    track->updated = 0;
    for (j = 5; j >= 0; j--) {
        /* What is a smaller share of a variance is rounding. */
        const doppler_real part = 8 * DOPPLER_EPSILON * P0[7 * j];
        const doppler_real least = part > 0 ? part : 0;
        doppler_real D = P0[7 * j];
        for (k = j + 1; k < 6; k++)
            D -= U[at(j, k)] * U[at(j, k)] * U[at(k, k)];
        U[at(j, j)] = D > least ? D : least;
        for (i = 0; i < j; i++) {
            doppler_real product = P0[6 * i + j];
            for (k = j + 1; k < 6; k++)
                product -= U[at(i, k)] * U[at(k, k)] * U[at(j, k)];
            U[at(i, j)] = D > least ? product / D : 0;
        }
    }
}

void doppler_cycle(doppler_track *track, const doppler_setting *setting,
                   doppler_real T, const doppler_real *z)
{
    doppler_real predicted[21], noise[6], gain[2];
    doppler_real linear[7];          /* innovation, gradient */
    doppler_real correction[7] = {0}; /* of the state; NIS */
    doppler_real lower, upper;
    int i, n, seen = 0;

    predict(track->x, track->factors, T);
    gains(gain, T, setting->sigma_a);
    for (n = 0; n < (int)setting->noise; n++) {
        for (i = 0; i < 3; i++) {
            const int driven = setting->noise == DOPPLER_SHARED || i == n;
            noise[i] = driven ? gain[0] : 0;
            noise[i + 3] = driven ? gain[1] : 0;
        }
        add_noise(track->factors, noise, DOPPLER_NOTHING);
    }
    for (i = 0; i < 21; i++)
        predicted[i] = track->factors[i];
    for (n = 0; n < setting->sensors; n++) {
        if (isnan(z[n]))
            continue;
        seen++;
        linearize(track->x, setting->positions + 3 * n, linear, z[n],
                  setting->doppler_per_speed);
        update(track->factors, correction, linear, setting->variance[n]);
    }
    lower = setting->lower ? setting->lower[seen] : 0;
    upper = setting->upper ? setting->upper[seen] : DOPPLER_LARGEST;
    track->nis = seen > 0 ? correction[6] : (doppler_real)NAN;
    track->updated = track->nis >= lower && track->nis <= upper;
    if (track->updated)
        correct(track->x, correction);
    else
        for (i = 0; i < 21; i++)
            track->factors[i] = predicted[i];
}

void doppler_covariance(const doppler_track *track, doppler_real *P)
{
    doppler_real upper[21];
    int i, j;

    covariance(track->factors, upper);
    for (i = 0; i < 6; i++)
        for (j = i; j < 6; j++)
            P[6 * i + j] = P[6 * j + i] = upper[at(i, j)];
}

doppler_decision doppler_stop(const doppler_track *track,
                              const doppler_setting *setting)
{
    doppler_decision decision;
    doppler_real found[3]; /* distance, its deviation, its quantile */

    nearest(track->x, track->factors, setting->point, found,
            setting->quantile);
    decision.distance = found[0];
    decision.distance_std = found[1];
    decision.alarm = !(found[2] > setting->distance);
    return decision;
}
