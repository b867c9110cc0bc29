/* Setting of main.c: Fig 6 of Mittermaier et al. (2016), with an alarm of ours.
 *
 * Printed by tools/kernels.py: change it there, or in a copy of your own.
 */
#define SENSORS 6
#define INTERVAL 0.001 /* before the first sample, in s */

#define R(number) ((doppler_real)(number))

/* of the sensors in m: x, y, z */
static const doppler_real POSITIONS[] = {
    R(0.0), R(0.2), R(0.0),
    R(0.0), R(0.10000000000000003), R(0.17320508075688773),
    R(0.0), R(-0.09999999999999996), R(0.17320508075688776),
    R(0.0), R(-0.2), R(2.4492935982947065e-17),
    R(0.0), R(-0.10000000000000009), R(-0.17320508075688767),
    R(0.0), R(0.10000000000000003), R(-0.17320508075688773)
};
/* of the shifts in Hz^2 */
static const doppler_real VARIANCE[] = {
    R(0.16000000000000003), R(0.16000000000000003), R(0.16000000000000003),
    R(0.16000000000000003), R(0.16000000000000003), R(0.16000000000000003)
};
/* state one interval before the first sample */
static const doppler_real START[] = {
    R(0.767757), R(0.086113), R(0.124076), R(-0.757), R(-0.113), R(-0.076)
};
/* its covariance */
static const doppler_real START_COVARIANCE[] = {
    R(0.1), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0),
    R(0.0), R(0.1), R(0.0), R(0.0), R(0.0), R(0.0),
    R(0.0), R(0.0), R(0.1), R(0.0), R(0.0), R(0.0),
    R(0.0), R(0.0), R(0.0), R(0.1), R(0.0), R(0.0),
    R(0.0), R(0.0), R(0.0), R(0.0), R(0.1), R(0.0),
    R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.1)
};
/* of the gate, two-sided, for 0 to 6 sensors */
static const doppler_real LOWER[] = {
    R(-3.4028234663852886e+38), R(0.0009820691171752583),
    R(0.050635615968579795), R(0.21579528262389797), R(0.48441855708793014),
    R(0.831211613486663), R(1.237344245791203)
};
/* and above */
static const doppler_real UPPER[] = {
    R(3.4028234663852886e+38), R(5.023886187314888), R(7.377758908227871),
    R(9.348403604496148), R(11.143286781877796), R(12.832501994030027),
    R(14.44937533544792)
};

static const doppler_setting SETTING = {
    SENSORS, POSITIONS, VARIANCE,
    R(160.0), /* 2 / wavelength */
    R(0.4), /* sigma_a */
    DOPPLER_SHARED,
    LOWER, UPPER,
    {R(0.0), R(0.0), R(0.0)}, /* the point that the target must not come near */
    R(0.25), /* nearer than that, in m */
    R(-3.090232306167813) /* with a probability of 0.001 */
};
