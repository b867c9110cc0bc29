"""One valid call of every public function of estimation and tracking that takes numbers.

Tests of what all of them share (`tests/test_edges.py`) change one argument of such a call.
"""

import copy
import inspect
from importlib import import_module
from pkgutil import iter_modules

import numpy as np

from dopplerlib import RadarArray, TrackManager, doppler_shift, kf
from dopplerlib.estimation import (
    colored_errors,
    ekf_online,
    extended_kalman,
    extended_update,
    gaussian_sum,
    imm,
    imm_online,
    linear_kalman,
    maximum_likelihood,
    nonlinear_kalman,
    online,
    radial_velocity,
    robust_kalman,
    smoother,
    steady_state,
    thinning,
    variable_projection,
    whitening,
)
from dopplerlib.estimation.imm_records import ImmModel
from dopplerlib.model.motion import cwna_process_noise, ncv_transition
from dopplerlib.tracking import association, bilateration, fusion, gates, multi_target, pda
from tests.fuzz.targets import example_calls

K, n, m = 4, 2, 1
F, Q = ncv_transition(0.5, dim=1), cwna_process_noise(0.5, 0.3, dim=1)
H, R = np.array([[1.0, 0.2]]), np.array([[0.4]])
H3, three = np.array([[1.0, 0.2], [0.3, 1.0], [1.0, -1.0]]), 0.4 * np.eye(3)
x, P = np.array([1.0, -0.5]), np.array([[2.0, 0.3], [0.3, 1.0]])
z = np.array([[0.5], [0.1], [-0.4], [0.2]])
array, state = RadarArray.linear(5, 0.4), [0.5, 0.2, 0.0, -1.0, 0.5, 0.0]
shifts = doppler_shift(state, array) + 0.1 * np.arange(20.0).reshape(4, 5)
box = [0.1, -1, 0, -2, -2, 0], [2, 1, 0, 2, 2, 0]
two = {"x1": x, "P1": P, "x2": x + 0.1, "P2": P.T * 2}
nonlinear = {"h": lambda x: x @ H.T, "H": lambda x: H}
track = kf(z, F, Q, H, R, x, P)
models, switch = [ImmModel(F, q * Q, H, R) for q in (1, 4)], [[0.9, 0.1], [0.2, 0.8]]


def start(z):
    return np.concatenate([z, 0 * z], axis=-1), np.broadcast_to(P, (len(z), n, n))


CALLS = {
    linear_kalman.kf_predict: {"x": x, "P": P, "F": F, "Q": Q},
    linear_kalman.kf_update: {"x": x, "P": P, "z": z[0], "H": H, "R": R},
    linear_kalman.kf: {"z": z, "F": F, "Q": Q, "H": H, "R": R, "x0": x, "P0": P},
    extended_update.ekf_update: {"x": x, "P": P, "z": z[0], "R": R, "wrap": (0,), "accept": True}
    | nonlinear,
    nonlinear_kalman.ekf_records: {
        "z": z, "f": lambda x: x @ F.T, "F": lambda x: F, "Q": Q, "R": R, "x0": x, "P0": P,
        "wrap": (0,), "gate": "upper", "gate_probability": 0.9, "iterations": 2,
    } | nonlinear,
    nonlinear_kalman.ukf: {
        "z": z, "f": lambda x: x @ F.T, "Q": Q, "h": nonlinear["h"], "R": R, "x0": x, "P0": P,
        "points": "unscented", "alpha": 0.5, "beta": 2.0, "kappa": 0.5,
        "wrap": (0,), "gate": "upper", "gate_probability": 0.9, "iterations": 2,
    },
    ekf_online.ekf_online: {
        "array": RadarArray.ring(3, 0.2), "x0": state, "P0": 0.01 * np.eye(6), "T": 0.001,
        "sigma_a": 0.4, "sigma_f": 0.4, "keep": ("P", "S", "innovation"),
    },
    online.ekf_records_online: {
        "f": lambda x: x @ F.T, "F": lambda x: F, "Q": Q, "R": three, "x0": x, "P0": P,
        "h": lambda x: x @ H3.T, "H": lambda x: H3,
        "wrap": (0,), "gate": "upper", "gate_probability": 0.9, "iterations": 2,
    },
    online.ukf_online: {
        "f": lambda x: x @ F.T, "Q": Q, "h": lambda x: x @ H3.T, "R": three, "x0": x, "P0": P,
        "points": "unscented", "alpha": 0.5, "beta": 2.0, "kappa": 0.5,
        "wrap": (0,), "gate": "upper", "gate_probability": 0.9, "iterations": 2,
    },
    robust_kalman.robust_ekf: {
        "z": z, "f": lambda x: x @ F.T, "F": lambda x: F, "Q": Q, "R": R, "x0": x, "P0": P,
        "method": "student-t", "threshold": 1.345, "degrees": 4.0, "gate_probability": 0.9,
        "memory": 100.0,
    } | nonlinear,
    imm.imm: {
        "z": z, "models": models, "x0": x, "P0": P, "transition": switch, "mode0": [0.5, 0.5],
    },
    imm_online.imm_online: {
        "models": [ImmModel(F, q * Q, H3, three) for q in (1, 4)], "x0": x, "P0": P,
        "transition": switch, "mode0": [0.5, 0.5],
    },
    imm.imm_start: {"models": models, "x0": x, "P0": P, "mode0": [0.5, 0.5]},
    imm.imm_step: {
        "z": z[0], "state": imm.imm_start(models, x, P), "models": models, "transition": switch,
    },
    smoother.rts_smooth: {"x": track.x, "P": track.P, "F": F, "Q": Q},
    steady_state.steady_state_gain: {"F": F, "Q": Q, "H": H, "R": R},
    steady_state.steady_state_lag: {"F": F, "H": H, "K": [[0.5], [0.4]], "push": [0.1, 0.2]},
    colored_errors.augment_linear: {
        "F": F, "Q": Q, "H": H, "R": R, "x0": x, "P0": P, "sigma": 0.3, "tau": 2.0, "T": 0.5,
    },
    colored_errors.augment_functions: {
        "f": lambda x: x @ F.T, "F": lambda x: F, "Q": Q, "R": R, "x0": x, "P0": P,
        "sigma": 0.3, "tau": 2.0, "T": 0.5,
    } | nonlinear,
    thinning.remedy_errors: {"F": F, "Q": Q, "H": H, "rho": 0.8, "every": 3, "sigma": 2.0},
    radial_velocity.radial_velocity_terms: {"x": x, "P": P, "sigma": 0.1},
    radial_velocity.radial_velocity_update: {"x": x, "P": P, "z": 0.3, "sigma": 0.1},
    extended_kalman.ekf: {
        "z": shifts, "array": array, "x0": state, "P0": 0.01 * np.eye(6), "T": 0.001,
        "sigma_a": 0.4, "sigma_f": 0.4, "keep": ("P", "S", "innovation"), "workers": 1,
    },
    gaussian_sum.gaussian_sum_online: {
        "array": RadarArray.ring(3, 0.2), "x0": [0.8, 0, 0, -0.7, 0, 0], "P0": 0.01 * np.eye(6),
        "T": 0.001, "sigma_a": 0.4, "sigma_f": 0.4, "block": 1,
    },
    extended_kalman.gate_bounds: {"gate": "upper", "sensors": 6, "gate_probability": 0.9},
    maximum_likelihood.ml_initialize: {
        "z": shifts, "array": array, "sigma_f": 0.1, "T": 0.001, "box": box, "workers": 1,
    },
    whitening.whitening_matrices: {
        "correlation": [1.0, 0.3], "there": np.ones((4, 2), bool),
    },
    variable_projection.log_position_density: {
        "z": shifts, "array": array, "sigma_f": 0.4, "p": [0.5, 0.2, 0.1], "x0": state,
        "P0": np.eye(6),
    },
    variable_projection.velocity_given_position: {
        "z": shifts[0], "array": array, "sigma_f": 0.1, "p": state[:3], "in_plane": True,
    },
    association.nearest_neighbor: {"distance": [1.0, 2.0], "accept": [False, True]},
    association.greedy_assign: {"cost": [[1.0, 2.0], [2.0, 8.0]], "gate": 5.0},
    association.gnn_assign: {"cost": [[1.0, 2.0], [2.0, 8.0]], "gate": 5.0},
    bilateration.bilaterate: {"d1": 2.0, "d2": 2.0, "baseline": 1.0},
    fusion.fuse_state_vectors: two | {"P12": 0.1 * np.eye(n)},
    fusion.cross_covariance_step: {
        "P12": P, "F": F, "Q": Q, "K1": [[0.5], [0.1]], "H1": H, "K2": [[0.4], [0.2]], "H2": H,
    },
    fusion.covariance_intersection: two | {"w": 0.5},
    fusion.fuse_measurements: {"z1": x, "R1": P, "z2": x + 0.1, "R2": 2 * P},
    gates.chi2_gate: {"nis": [1.0, 9.0], "m": 2, "gate_probability": 0.95},
    gates.fixed_box_gate: {"innovation": x, "half_widths": [0.5, 1.0]},
    multi_target.track_scans: {
        "scans": [z[:2], z[1:2], z[2:]], "F": F, "Q": Q, "R": R, "start": start,
        "manager": TrackManager(2, 3, 3), "gate_probability": 0.99, "wrap": (0,),
    } | nonlinear,
    pda.pda_update: {
        "x": x, "P": P, "z": z, "H": H, "R": R, "detection": 0.9, "density": 0.1, "gate": 0.99,
    },
}  # fmt: skip

# Arguments by what they are. An argument of these names is of this kind in every function.
COVARIANCES = ("P", "P0", "P1", "P2", "Q", "R", "R1", "R2")
ITERABLES = ("wrap", "scans", "keep", "box", "models")
BOOLEANS = ("accept", "in_plane", "there")
NOT_NUMBERS = (
    "points", "array", "start", "manager", "h", "gate", "state", "method", "rng",
    *ITERABLES, *BOOLEANS,
)  # fmt: skip


def call(function, **changed):
    """Return what the valid call gives with some arguments changed, or left out if None."""
    arguments = CALLS[function] | changed
    if isinstance(arguments.get("rng"), np.random.Generator):
        arguments["rng"] = copy.deepcopy(arguments["rng"])  # every call draws the same
    return function(**{name: value for name, value in arguments.items() if value is not None})


def results(value):
    """Return the arrays and numbers of a result, of records and lists of them as well.

    A function is told by its value at a state with an error beside it, or at three shifts.
    """
    if callable(value):
        return results(value(np.arange(1.0, n + m + 1)))
    if isinstance(value, dict):
        return results([*value.values()])
    if isinstance(value, (list, tuple)):
        return [one for part in value for one in results(part)]
    if hasattr(value, "__dataclass_fields__"):
        return results([getattr(value, name) for name in value.__dataclass_fields__])
    return [] if value is None else [np.asarray(value)]


# Modules of functions for the house, whose callers check.
UNCHECKED = ("covariances", "densities", "gaussian", "models", "recursion", "sigma_points")


def public_functions():
    """Return every function of estimation and tracking whose module and own name are public."""
    found = []
    for package in ("estimation", "tracking"):
        folder = import_module(f"dopplerlib.{package}")
        for module in iter_modules(folder.__path__, f"{folder.__name__}."):
            name = module.name.rpartition(".")[2]
            if not name.startswith("_") and name not in UNCHECKED:
                members = vars(import_module(module.name)).values()
                found += [
                    value
                    for value in members
                    if inspect.isfunction(value)
                    and value.__module__ == module.name
                    and not value.__name__.startswith("_")
                ]
    return found


# What `ekf_update` is made of is tried through it.
INSIDE = {
    getattr(extended_update, name) for name in ("linearized", "predicted_measurement", "wrapped")
}
# A function without a call above is tried with the one that the example in its docstring makes.
for _function in public_functions():
    if _function not in CALLS and _function not in INSIDE:
        if _calls := example_calls(_function.__module__, _function):
            CALLS[_function] = _calls[0]


def with_argument(names):
    """Return pairs (function, argument) of all calls that have an argument of these names."""
    return [
        (function, name)
        for function, arguments in CALLS.items()
        for name in arguments
        if name in names and not callable(arguments[name])
    ]


def label(value):
    """Return what pytest calls a parameter."""
    return value.__name__ if callable(value) else None
