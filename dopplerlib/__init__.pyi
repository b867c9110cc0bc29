# Made by python -m tools.stubs; do not edit.
from . import chain as chain
from . import commandline as commandline
from . import derive as derive
from . import estimation as estimation
from . import evaluation as evaluation
from . import figures as figures
from . import kernels as kernels
from . import model as model
from . import replication as replication
from . import signal as signal
from . import systems as systems
from . import tracking as tracking
from . import workspace as workspace
from .chain.baseband import Baseband as Baseband
from .chain.track import IqTrack as IqTrack
from .chain.track import track_iq as track_iq
from .estimation.ekf_online import ekf_online as ekf_online
from .estimation.extended_kalman import ekf as ekf
from .estimation.extended_kalman import gate_bounds as gate_bounds
from .estimation.extended_update import ekf_update as ekf_update
from .estimation.imm import imm as imm
from .estimation.imm import imm_start as imm_start
from .estimation.imm import imm_step as imm_step
from .estimation.imm_online import imm_online as imm_online
from .estimation.imm_records import ImmModel as ImmModel
from .estimation.initial_estimate import InitialEstimate as InitialEstimate
from .estimation.linear_kalman import kf as kf
from .estimation.linear_kalman import kf_predict as kf_predict
from .estimation.linear_kalman import kf_update as kf_update
from .estimation.maximum_likelihood import ml_initialize as ml_initialize
from .estimation.nonlinear_kalman import ekf_records as ekf_records
from .estimation.nonlinear_kalman import ukf as ukf
from .estimation.online import ekf_records_online as ekf_records_online
from .estimation.online import ukf_online as ukf_online
from .estimation.smoother import rts_smooth as rts_smooth
from .estimation.steady_state import steady_state_gain as steady_state_gain
from .estimation.steady_state import steady_state_lag as steady_state_lag
from .estimation.track import Track as Track
from .evaluation.averages import average_interval as average_interval
from .evaluation.averages import effective_samples as effective_samples
from .evaluation.averages import nees_samples as nees_samples
from .evaluation.bounds import crlb as crlb
from .evaluation.consistency import chi2_interval as chi2_interval
from .evaluation.consistency import nees as nees
from .evaluation.consistency import nis as nis
from .evaluation.directions import principal_axis_errors as principal_axis_errors
from .evaluation.table import Table as Table
from .evaluation.whiteness import innovation_mean as innovation_mean
from .evaluation.whiteness import innovation_whiteness as innovation_whiteness
from .model.ambiguity import ring_family as ring_family
from .model.ambiguity import ring_family_direction as ring_family_direction
from .model.ambiguity import ring_family_limits as ring_family_limits
from .model.coordinated_turn import coordinated_turn as coordinated_turn
from .model.coordinated_turn import coordinated_turn_jacobian as coordinated_turn_jacobian
from .model.doppler import doppler_jacobian as doppler_jacobian
from .model.doppler import doppler_shift as doppler_shift
from .model.information import fisher_information as fisher_information
from .model.links import DopplerLinks as DopplerLinks
from .model.motion import constant_velocity as constant_velocity
from .model.radar_array import RadarArray as RadarArray
from .model.scenario import Scenario as Scenario
from .model.simulation import simulate as simulate
from .signal.frequency import ml_frequency as ml_frequency
from .signal.laws import crlb_frequency_std as crlb_frequency_std
from .signal.recording import Recording as Recording
from .signal.recording import read_sigmf as read_sigmf
from .signal.recording import read_wav as read_wav
from .signal.sliding import DopplerRecord as DopplerRecord
from .signal.sliding import sliding_doppler as sliding_doppler
from .signal.synthesis import iq_from_geometry as iq_from_geometry
from .tracking.association import gnn_assign as gnn_assign
from .tracking.gates import chi2_gate as chi2_gate
from .tracking.management import TrackManager as TrackManager

__all__ = [
    "Baseband",
    "DopplerLinks",
    "DopplerRecord",
    "ImmModel",
    "InitialEstimate",
    "IqTrack",
    "RadarArray",
    "Recording",
    "Scenario",
    "Table",
    "Track",
    "TrackManager",
    "average_interval",
    "chi2_gate",
    "chi2_interval",
    "constant_velocity",
    "coordinated_turn",
    "coordinated_turn_jacobian",
    "crlb",
    "crlb_frequency_std",
    "doppler_jacobian",
    "doppler_shift",
    "effective_samples",
    "ekf",
    "ekf_online",
    "ekf_records",
    "ekf_records_online",
    "ekf_update",
    "fisher_information",
    "gate_bounds",
    "gnn_assign",
    "imm",
    "imm_online",
    "imm_start",
    "imm_step",
    "innovation_mean",
    "innovation_whiteness",
    "iq_from_geometry",
    "kf",
    "kf_predict",
    "kf_update",
    "ml_frequency",
    "ml_initialize",
    "nees",
    "nees_samples",
    "nis",
    "principal_axis_errors",
    "read_sigmf",
    "read_wav",
    "ring_family",
    "ring_family_direction",
    "ring_family_limits",
    "rts_smooth",
    "simulate",
    "sliding_doppler",
    "steady_state_gain",
    "steady_state_lag",
    "track_iq",
    "ukf",
    "ukf_online",
]
__version__: str
