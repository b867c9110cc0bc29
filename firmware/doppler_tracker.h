/* Track a target by the Doppler shifts of N sensors, and decide when to stop.
 *
 * Printed by `make kernels` with SymPy 1.14.0. Do not edit: change
 * dopplerlib/derive and print again.
 */

/* One cycle of the extended Kalman filter for constant velocity (predict,
 * gate, update by N sensors) and the alarm of a machine that has to stop
 * before the target is too near. C99; no allocation, no recursion, no state
 * but that of the caller. From <math.h> it needs sqrt (or sqrtf), isnan, NAN.
 *
 * With DOPPLER_FLOAT defined all is in single precision; README.md states its
 * error. Fixed point is not provided. Do not compile with -ffast-math: NaN is
 * a missing measurement.
 *
 * Operations at worst, all N sensors there, counted in the printed formulas;
 * C is the number of columns of the process noise, see doppler_noise:
 *
 *                         one cycle    one decision
 *   additions         15 + 46 C +  75 N          20
 *   multiplications   10 + 55 C + 107 N          31
 *   divisions          1 +  5 C +   7 N           1
 *   square roots       0 +  0 C +   1 N           2
 *
 * Beside these stand comparisons, copies, and changes of sign.
 * Stack of a call: less than 1024 bytes, 512 in single precision (gcc
 * for x86-64, optimized). The state is one doppler_track.
 */
#ifndef DOPPLER_TRACKER_H
#define DOPPLER_TRACKER_H

#ifdef DOPPLER_FLOAT
typedef float doppler_real;
#else
typedef double doppler_real;
#endif

/* Random acceleration: one for all axes; one each for x and y; one each for
 * x, y and z. The value is the number of columns of the process noise. */
typedef enum {
    DOPPLER_SHARED = 1,
    DOPPLER_HORIZONTAL = 2,
    DOPPLER_PER_AXIS = 3
} doppler_noise;

/* What does not change from sample to sample. */
typedef struct {
    int sensors;                   /* N, one or more */
    const doppler_real *positions; /* x, y, z in m of each sensor: 3 N numbers */
    const doppler_real *variance;  /* sigma_f squared in Hz^2: N numbers */
    doppler_real doppler_per_speed; /* 2 / wavelength in 1/m */
    doppler_real sigma_a;          /* of the random acceleration, in m/s^2 */
    doppler_noise noise;
    /* Gate: a sample is used if its NIS is not below lower[n] and not above
     * upper[n], n sensors being there: N + 1 numbers each. NULL: no limit. */
    const doppler_real *lower, *upper;
    /* Decision: an alarm as soon as the target is nearer to the point than the
     * distance with some probability; of that, the standard normal quantile:
     * -3.0902 for a probability of 0.001. */
    doppler_real point[3], distance, quantile;
} doppler_setting;

/* The estimate; the caller owns it, one for each target. */
typedef struct {
    doppler_real x[6]; /* x, y, z in m; v_x, v_y, v_z in m/s */
    /* Of P = U D U', U unit upper triangular and D diagonal: row by row the
     * upper triangle of U, with D in place of its diagonal of ones. */
    doppler_real factors[21];
    doppler_real nis; /* of the last sample; NaN if nothing was measured */
    int updated;      /* whether the last sample was used */
} doppler_track;

typedef struct {
    doppler_real distance, distance_std; /* in m */
    int alarm;
} doppler_decision;

/* Start from the state x0 (6) and its covariance P0 (36, row by row) one
 * interval before the first sample. P0 may be singular. */
void doppler_start(doppler_track *track, const doppler_real *x0,
                   const doppler_real *P0);

/* Go on by one sample: the N shifts z in Hz, T seconds after the last one. A
 * NaN in z is a sensor that is missing. A sample that the gate refuses, or
 * whose NIS is no finite number, leaves the state predicted. */
void doppler_cycle(doppler_track *track, const doppler_setting *setting,
                   doppler_real T, const doppler_real *z);

/* Write the covariance (36, row by row) to P. */
void doppler_covariance(const doppler_track *track, doppler_real *P);

/* Decide. A track that holds no numbers any more is an alarm. */
doppler_decision doppler_stop(const doppler_track *track,
                              const doppler_setting *setting);

#endif
