"""The same extended Kalman filter, by the libraries on JAX: dynamax and cuthbert.

Each maker returns a function that filters one record z (K, N), or many (R, K, N) with `vmap`, and
returns x and P. Both compile once for each shape, in double precision, and compute on one thread.
Their Jacobians are those of JAX, forward, of the Doppler shift below: neither takes one that is
written by hand.
"""

import os

# Before JAX is loaded; both are read then.
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["JAX_PLATFORMS"] = "cpu"

import jax
import jax.numpy as jnp
import numpy as np
from cuthbert import filter as cuthbert_filter
from cuthbert.gaussian import moments
from dynamax.nonlinear_gaussian_ssm import ParamsNLGSSM, extended_kalman_filter

jax.config.update("jax_enable_x64", True)


def doppler(array):
    """Return the Doppler shift (N,) as a function of the state x (6,)."""
    positions, doppler_per_speed = jnp.asarray(array.positions), array.doppler_per_speed

    def shift(x):
        d = positions - x[:3]
        return doppler_per_speed * (d @ x[3:]) / jnp.sqrt(jnp.sum(d * d, axis=-1))

    return shift


def dynamax(array, x0, P0, F, Q, R):
    """Return dynamax's filter, which begins with an update: it gets the predicted start."""
    F, Q, R = map(jnp.asarray, (F, Q, R))
    fields = ["filtered_means", "filtered_covariances"]
    parameters = ParamsNLGSSM(
        initial_mean=F @ x0,
        initial_covariance=F @ P0 @ F.T + Q,
        dynamics_function=lambda x: F @ x,
        dynamics_covariance=Q,
        emission_function=doppler(array),
        emission_covariance=R,
    )

    def one(z):
        found = extended_kalman_filter(parameters, z, output_fields=fields)
        return found.filtered_means, found.filtered_covariances

    return compiled(one)


def cuthbert(array, x0, P0, F, gain, R):
    """Return cuthbert's filter by moments; it keeps factors, of which P is made at the end.

    gain: Column (6, 1) with Q = gain gain'.
    """
    F, gain, root_R = jnp.asarray(F), jnp.asarray(gain), jnp.linalg.cholesky(jnp.asarray(R))
    shift = doppler(array)
    ekf = moments.build_filter(
        x0,
        np.linalg.cholesky(P0),
        lambda state, z: (lambda x: (F @ x, gain), state.mean),
        lambda state, z: (lambda x: (shift(x), root_R), state.mean, z),
    )

    def one(z):
        states = cuthbert_filter(ekf, z, ekf.init_prepare())
        x, U = states.mean[1:], states.chol_cov[1:]  # without the start
        return x, U @ jnp.swapaxes(U, -1, -2)

    return compiled(one)


def compiled(one):
    """Return a function of one record or of many, which waits for its results."""
    single, many = jax.jit(one), jax.jit(jax.vmap(one))

    def run(z):
        return jax.block_until_ready((single if z.ndim == 2 else many)(z))

    return run
