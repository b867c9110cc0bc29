"""Doppler-only radar tracking: models, filters and their evaluation.

Names and packages are loaded when they are first used (PEP 562), so that importing the library
costs nothing and asks for numba only where compiled loops run.
"""

from ._lazy import attach, by_name

_HOME = by_name(
    {
        "model.radar_array": "RadarArray",
        "model.links": "DopplerLinks",
        "model.doppler": "doppler_shift doppler_jacobian",
        "model.motion": "constant_velocity",
        "model.coordinated_turn": "coordinated_turn coordinated_turn_jacobian",
        "model.scenario": "Scenario",
        "model.simulation": "simulate",
        "model.ambiguity": "ring_family ring_family_limits ring_family_direction",
        "model.information": "fisher_information",
        "signal.synthesis": "iq_from_geometry",
        "signal.frequency": "ml_frequency",
        "signal.laws": "crlb_frequency_std",
        "signal.sliding": "sliding_doppler DopplerRecord",
        "signal.recording": "Recording read_sigmf read_wav",
        "estimation.track": "Track",
        "estimation.extended_kalman": "ekf gate_bounds",
        "estimation.initial_estimate": "InitialEstimate",
        "estimation.maximum_likelihood": "ml_initialize",
        "estimation.linear_kalman": "kf kf_predict kf_update",
        "estimation.extended_update": "ekf_update",
        "estimation.nonlinear_kalman": "ekf_records ukf",
        "estimation.ekf_online": "ekf_online",
        "estimation.online": "ekf_records_online ukf_online",
        "estimation.imm": "imm imm_start imm_step",
        "estimation.imm_online": "imm_online",
        "estimation.imm_records": "ImmModel",
        "estimation.smoother": "rts_smooth",
        "estimation.steady_state": "steady_state_gain steady_state_lag",
        "tracking.gates": "chi2_gate",
        "tracking.association": "gnn_assign",
        "tracking.management": "TrackManager",
        "chain.baseband": "Baseband",
        "chain.track": "track_iq IqTrack",
        "evaluation.bounds": "crlb",
        "evaluation.table": "Table",
        "evaluation.consistency": "nees nis chi2_interval",
        "evaluation.averages": "average_interval effective_samples nees_samples",
        "evaluation.directions": "principal_axis_errors",
        "evaluation.whiteness": "innovation_mean innovation_whiteness",
    }
)

__all__ = sorted(_HOME)
__version__ = "0.1.0"
__getattr__, __dir__ = attach(__name__, __path__, _HOME)
