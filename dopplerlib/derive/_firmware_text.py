"""What stands around the printed formulas in header and source of the firmware."""

_PRINTED = """\
 * Printed by `make kernels` with SymPy {version}. Do not edit: change
 * dopplerlib/derive and print again.
 */
"""

HEADER = (
    """\
/* Track a target by the Doppler shifts of N sensors, and decide when to stop.
 *
"""
    + _PRINTED
    + """\

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
{operations}
 *
 * Beside these stand comparisons, copies, and changes of sign.
 * Stack of a call: less than {double} bytes, {float} in single precision (gcc
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
"""
)

SOURCE = (
    """\
/* Track a target by the Doppler shifts of N sensors, and decide when to stop.
 *
"""
    + _PRINTED
    + """\
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

{blocks}
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
"""
)
