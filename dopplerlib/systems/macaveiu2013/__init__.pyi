# Made by python -m tools.stubs; do not edit.
from . import claim_regions as claim_regions
from . import crossing as crossing
from . import evidence as evidence
from . import lag_prediction as lag_prediction
from . import linear_filter as linear_filter
from . import model_comparison as model_comparison
from . import motion_models as motion_models
from . import polar_filters as polar_filters
from . import processing as processing
from . import processing_study as processing_study
from . import published as published
from . import settings as settings
from . import signals as signals
from . import truth as truth
from .claim_regions import CLAIMS as CLAIMS
from .claim_regions import PathScores as PathScores
from .claim_regions import claim_borders as claim_borders
from .claim_regions import claim_borders_along as claim_borders_along
from .claim_regions import claim_map as claim_map
from .claim_regions import decided_claims as decided_claims
from .claim_regions import score_paths as score_paths
from .crossing import RULES as RULES
from .crossing import Crossing as Crossing
from .crossing import crossing_paths as crossing_paths
from .crossing import track_crossing as track_crossing
from .lag_prediction import acceleration_lag as acceleration_lag
from .lag_prediction import best_w as best_w
from .lag_prediction import settled_noise_std as settled_noise_std
from .lag_prediction import settled_rms as settled_rms
from .lag_prediction import velocity_response as velocity_response
from .linear_filter import VehicleRuns as VehicleRuns
from .linear_filter import filter_vehicle as filter_vehicle
from .linear_filter import gain_sequence as gain_sequence
from .linear_filter import measure_vehicle as measure_vehicle
from .linear_filter import track_vehicle as track_vehicle
from .linear_filter import tracking_errors as tracking_errors
from .model_comparison import AGILE as AGILE
from .model_comparison import JERKS as JERKS
from .model_comparison import STAYS as STAYS
from .model_comparison import STEPS as STEPS
from .model_comparison import model_errors as model_errors
from .model_comparison import saved_model_errors as saved_model_errors
from .motion_models import rms_of_runs as rms_of_runs
from .motion_models import smooth_vehicle as smooth_vehicle
from .motion_models import track_accelerating as track_accelerating
from .motion_models import track_two_models as track_two_models
from .polar_filters import measure_polar as measure_polar
from .polar_filters import polar_noise as polar_noise
from .polar_filters import start_polar as start_polar
from .polar_filters import track_polar as track_polar
from .polar_filters import track_polar_naive as track_polar_naive
from .processing import CLUTTER as CLUTTER
from .processing import MANAGER as MANAGER
from .processing import TARGET as TARGET
from .processing import VehicleScan as VehicleScan
from .processing import after_clutter_rule as after_clutter_rule
from .processing import group_detections as group_detections
from .processing import hidden_scans as hidden_scans
from .processing import is_moving as is_moving
from .processing import longest_gap as longest_gap
from .processing import reflection_points as reflection_points
from .processing import simulate_scans as simulate_scans
from .processing import track_objects as track_objects
from .processing_study import DetectionCounts as DetectionCounts
from .processing_study import SchemeOutcome as SchemeOutcome
from .processing_study import count_detections as count_detections
from .processing_study import deleted_fraction as deleted_fraction
from .processing_study import outcome_summary as outcome_summary
from .processing_study import saved_detections as saved_detections
from .processing_study import saved_outcomes as saved_outcomes
from .processing_study import study_outcome as study_outcome
from .processing_study import study_record as study_record
from .processing_study import study_variants as study_variants
from .published import KMH as KMH
from .published import Reported as Reported
from .published import reported as reported
from .settings import AutomotiveSettings as AutomotiveSettings
from .settings import automotive_settings as automotive_settings
from .signals import CAR as CAR
from .signals import PEDESTRIAN as PEDESTRIAN
from .signals import SLOPES as SLOPES
from .signals import noisy_echoes as noisy_echoes
from .truth import VehiclePath as VehiclePath
from .truth import hard_turn as hard_turn
from .truth import vehicle_paths as vehicle_paths

__all__ = [
    "AGILE",
    "CAR",
    "CLAIMS",
    "CLUTTER",
    "JERKS",
    "KMH",
    "MANAGER",
    "PEDESTRIAN",
    "RULES",
    "SLOPES",
    "STAYS",
    "STEPS",
    "TARGET",
    "AutomotiveSettings",
    "Crossing",
    "DetectionCounts",
    "PathScores",
    "Reported",
    "SchemeOutcome",
    "VehiclePath",
    "VehicleRuns",
    "VehicleScan",
    "acceleration_lag",
    "after_clutter_rule",
    "automotive_settings",
    "best_w",
    "claim_borders",
    "claim_borders_along",
    "claim_map",
    "count_detections",
    "crossing_paths",
    "decided_claims",
    "deleted_fraction",
    "filter_vehicle",
    "gain_sequence",
    "group_detections",
    "hard_turn",
    "hidden_scans",
    "is_moving",
    "longest_gap",
    "measure_polar",
    "measure_vehicle",
    "model_errors",
    "noisy_echoes",
    "outcome_summary",
    "polar_noise",
    "reflection_points",
    "reported",
    "rms_of_runs",
    "saved_detections",
    "saved_model_errors",
    "saved_outcomes",
    "score_paths",
    "settled_noise_std",
    "settled_rms",
    "simulate_scans",
    "smooth_vehicle",
    "start_polar",
    "study_outcome",
    "study_record",
    "study_variants",
    "track_accelerating",
    "track_crossing",
    "track_objects",
    "track_polar",
    "track_polar_naive",
    "track_two_models",
    "track_vehicle",
    "tracking_errors",
    "vehicle_paths",
    "velocity_response",
]
