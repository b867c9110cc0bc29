"""The test that each test file of this folder runs on the functions of one package."""

import pytest

from .run import fuzz
from .targets import discover

EXAMPLES = 10  # odd calls of each function, the same ones every time; `make fuzz` makes more
OF_ROOMS = 5  # of the functions of one document, which take longer
FEW = 4  # of those that take more than 20 ms a call
SLOW = {
    "chain.alternatives.explain",
    "evaluation.symptoms.symptoms",
    "replication.judgments.judgments_text",
    "replication.judgments.read_judgments",
    "replication.judgments.verdicts_on_page",
    "systems.macaveiu2013.claim_regions.PathScores",
    "systems.macaveiu2013.model_comparison.model_errors",
    "systems.valarmathi.algorithms.AlgorithmRuns",
    "systems.valarmathi.fusion_sweep.FusionSweep",
    "evaluation.frequency_benchmark.FrequencyBenchmark",
    "signal.waveforms.range_doppler_map",
    "systems.asheim2015.published.Reported",
    "systems.macaveiu2013.claim_regions.score_paths",
    "systems.macaveiu2013.truth.VehiclePath",
    "systems.mittermaier2016.noise_sweep.run_noise_sweep",
    "systems.mittermaier2016.published.Reported",
    "systems.mittermaier2016.start.samples_needed",
    "workspace.errors.ErrorSummary",
    "workspace.comparison.case_errors",
    "workspace.trackers.track_targets",
}


def of_package(package):
    """Return a test, for each public function of a package of the library, of odd calls."""
    targets = discover(f"dopplerlib.{package}")
    examples = OF_ROOMS if package.startswith("systems.") else EXAMPLES

    @pytest.mark.parametrize("target", targets, ids=lambda target: target.name)
    def test_odd_arguments_are_refused_by_name_or_give_finite_results(target):
        outcome = fuzz(target, FEW if target.name in SLOW else examples)
        assert not outcome.bad, "\n".join(outcome.bad)

    return test_odd_arguments_are_refused_by_name_or_give_finite_results
