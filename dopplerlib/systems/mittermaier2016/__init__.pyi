# Made by python -m tools.stubs; do not edit.
from . import chain_bounds as chain_bounds
from . import chain_errors as chain_errors
from . import chain_sums as chain_sums
from . import end_to_end as end_to_end
from . import error_maps as error_maps
from . import evidence as evidence
from . import example as example
from . import noise_sweep as noise_sweep
from . import published as published
from . import readings as readings
from . import simulated_iq as simulated_iq
from . import start as start
from .chain_bounds import median_error as median_error
from .chain_bounds import position_bound as position_bound
from .chain_bounds import position_bound_iq as position_bound_iq
from .chain_bounds import record_length as record_length
from .chain_errors import TrackErrors as TrackErrors
from .chain_errors import track_errors as track_errors
from .chain_sums import saved_sum_errors as saved_sum_errors
from .chain_sums import sum_errors as sum_errors
from .end_to_end import track_iq as track_iq
from .error_maps import ErrorMap as ErrorMap
from .error_maps import comparable as comparable
from .error_maps import error_map as error_map
from .error_maps import error_map_bound as error_map_bound
from .error_maps import fraction_above as fraction_above
from .example import ExampleRuns as ExampleRuns
from .example import run_example as run_example
from .noise_sweep import NoiseSweep as NoiseSweep
from .noise_sweep import SweepReading as SweepReading
from .noise_sweep import error_limits as error_limits
from .noise_sweep import grid_points as grid_points
from .noise_sweep import mean_norm as mean_norm
from .noise_sweep import noise_levels as noise_levels
from .noise_sweep import run_noise_sweep as run_noise_sweep
from .noise_sweep import sweep_array as sweep_array
from .noise_sweep import sweep_bounds as sweep_bounds
from .published import PublishedFigure3 as PublishedFigure3
from .published import PublishedFigure4 as PublishedFigure4
from .published import PublishedFigure6 as PublishedFigure6
from .published import Reported as Reported
from .published import reported as reported
from .readings.ablation import Consistency as Consistency
from .readings.ablation import ablated_ekf as ablated_ekf
from .readings.ablation import consistency_runs as consistency_runs
from .readings.ablation import matched_P0 as matched_P0
from .readings.ablation import range_claims as range_claims
from .readings.combinations import combination_runs as combination_runs
from .readings.combinations import saved_combinations as saved_combinations
from .readings.example import ExampleReadings as ExampleReadings
from .readings.example import example_readings as example_readings
from .readings.example import example_summary as example_summary
from .readings.example import ruled_out as ruled_out
from .readings.example import still_counts as still_counts
from .readings.faults import faulty_filters as faulty_filters
from .readings.faults import linear_filter as linear_filter
from .readings.faults import linear_world as linear_world
from .readings.maps import ORIENTATIONS as ORIENTATIONS
from .readings.maps import MapReading as MapReading
from .readings.maps import map_readings as map_readings
from .readings.maps import map_score as map_score
from .readings.noise_sweep import DotsStructure as DotsStructure
from .readings.noise_sweep import coarse_readings as coarse_readings
from .readings.noise_sweep import dots_log_likelihood as dots_log_likelihood
from .readings.noise_sweep import dots_structure as dots_structure
from .readings.noise_sweep import saved_coarse_sweeps as saved_coarse_sweeps
from .readings.noise_sweep import saved_noise_sweep as saved_noise_sweep
from .readings.noise_sweep import saved_sweep_readings as saved_sweep_readings
from .readings.noise_sweep import scored_levels as scored_levels
from .readings.noise_sweep import sweep_readings as sweep_readings
from .readings.noise_sweep import sweep_score as sweep_score
from .simulated_iq import SIMULATED as SIMULATED
from .simulated_iq import read_simulated_iq as read_simulated_iq
from .simulated_iq import simulated_recording as simulated_recording
from .simulated_iq import write_simulated_iq as write_simulated_iq
from .start import Starts as Starts
from .start import samples_needed as samples_needed
from .start import start_box as start_box
from .start import start_misfit as start_misfit
from .start import table2_starts as table2_starts

__all__ = [
    "ORIENTATIONS",
    "SIMULATED",
    "Consistency",
    "DotsStructure",
    "ErrorMap",
    "ExampleReadings",
    "ExampleRuns",
    "MapReading",
    "NoiseSweep",
    "PublishedFigure3",
    "PublishedFigure4",
    "PublishedFigure6",
    "Reported",
    "Starts",
    "SweepReading",
    "TrackErrors",
    "ablated_ekf",
    "coarse_readings",
    "combination_runs",
    "comparable",
    "consistency_runs",
    "dots_log_likelihood",
    "dots_structure",
    "error_limits",
    "error_map",
    "error_map_bound",
    "example_readings",
    "example_summary",
    "faulty_filters",
    "fraction_above",
    "grid_points",
    "linear_filter",
    "linear_world",
    "map_readings",
    "map_score",
    "matched_P0",
    "mean_norm",
    "median_error",
    "noise_levels",
    "position_bound",
    "position_bound_iq",
    "range_claims",
    "read_simulated_iq",
    "record_length",
    "reported",
    "ruled_out",
    "run_example",
    "run_noise_sweep",
    "samples_needed",
    "saved_coarse_sweeps",
    "saved_combinations",
    "saved_noise_sweep",
    "saved_sum_errors",
    "saved_sweep_readings",
    "scored_levels",
    "simulated_recording",
    "start_box",
    "start_misfit",
    "still_counts",
    "sum_errors",
    "sweep_array",
    "sweep_bounds",
    "sweep_readings",
    "sweep_score",
    "table2_starts",
    "track_errors",
    "track_iq",
    "write_simulated_iq",
]
