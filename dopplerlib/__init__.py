"""Doppler-only radar tracking: models, filters and their evaluation.

Names and packages are loaded when they are first used (PEP 562), so that importing the library
costs nothing and asks for numba only where compiled loops run.
"""

from ._lazy import attach

_HOME = {
    "RadarArray": "model.radar_array",
    "doppler_shift": "model.doppler",
    "doppler_jacobian": "model.doppler",
    "constant_velocity": "model.motion",
    "coordinated_turn": "model.coordinated_turn",
    "coordinated_turn_jacobian": "model.coordinated_turn",
    "Scenario": "model.scenario",
    "simulate": "model.simulation",
    "iq_from_geometry": "signal.synthesis",
    "ml_frequency": "signal.frequency",
    "crlb_frequency_std": "signal.laws",
    "sliding_doppler": "signal.sliding",
    "DopplerRecord": "signal.sliding",
    "Recording": "signal.recording",
    "read_sigmf": "signal.recording",
    "read_wav": "signal.recording",
    "Track": "estimation.track",
    "ekf": "estimation.extended_kalman",
    "gate_bounds": "estimation.extended_kalman",
    "ml_initialize": "estimation.maximum_likelihood",
    "InitialEstimate": "estimation.maximum_likelihood",
    "kf": "estimation.linear_kalman",
    "kf_predict": "estimation.linear_kalman",
    "kf_update": "estimation.linear_kalman",
    "ekf_update": "estimation.extended_update",
    "ekf_records": "estimation.nonlinear_kalman",
    "ukf": "estimation.nonlinear_kalman",
    "imm": "estimation.imm",
    "imm_start": "estimation.imm",
    "imm_step": "estimation.imm",
    "ImmModel": "estimation.imm_records",
    "rts_smooth": "estimation.smoother",
    "steady_state_gain": "estimation.steady_state",
    "steady_state_lag": "estimation.steady_state",
    "chi2_gate": "tracking.gates",
    "gnn_assign": "tracking.association",
    "TrackManager": "tracking.management",
    "Baseband": "chain.baseband",
    "track_iq": "chain.track",
    "IqTrack": "chain.track",
    "ring_family": "model.ambiguity",
    "ring_family_limits": "model.ambiguity",
    "ring_family_direction": "model.ambiguity",
    "fisher_information": "model.information",
    "crlb": "evaluation.bounds",
    "Table": "evaluation.table",
    "nees": "evaluation.consistency",
    "nis": "evaluation.consistency",
    "chi2_interval": "evaluation.consistency",
    "average_interval": "evaluation.averages",
    "effective_samples": "evaluation.averages",
    "principal_axis_errors": "evaluation.directions",
    "nees_samples": "evaluation.averages",
    "innovation_mean": "evaluation.whiteness",
    "innovation_whiteness": "evaluation.whiteness",
}

__all__ = sorted(_HOME)
__version__ = "0.1.0"
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
