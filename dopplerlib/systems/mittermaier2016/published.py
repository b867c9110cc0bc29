"""Values that the paper prints and draws, from ``data/mittermaier2016``."""

from functools import cache
from typing import Annotated

import numpy as np

from ... import _checks
from ..._data import read_json, read_lines, read_toml
from ..._hints import Array, Booleans, Positive, State, checked, exactly
from ..._records import record
from ..._typing import FloatArray
from ...model.radar_array import RadarArray
from ...model.scenario import Scenario
from ...replication.documents import data_file
from ...replication.published import Published, read_published


@checked
@record
class PublishedFigure3:
    """The two error maps of Fig 3, read off a pixel image, and the settings that go with them.

    The first axis of a map is x, upwards in the figure; the second is y, to the right.

    x, y (39,): Places in m.
    error (2, 39, 39): Errors in m, one map for each entry of `samples`; NaN where not known.
    below (2, 39, 39): Where the error is only known to be below `lowest`.
    array: Sensors as the figure draws them.
    velocity (3,): Of the target in m/s, the same at every place.
    samples: Number of samples behind each map.
    T, sigma_f: Sampling interval in s, standard deviation of the Doppler shifts in Hz.
    top_speed: Speed of the drives in m/s, to which the search is restricted.
    lowest, highest: First and last contour in m.
    """

    x: Annotated[FloatArray, exactly(None)]
    y: Annotated[FloatArray, exactly(None)]
    error: Array
    below: Booleans
    array: RadarArray
    velocity: Annotated[FloatArray, exactly(3)]
    samples: tuple[int, ...]
    T: Positive
    sigma_f: Positive
    top_speed: Positive
    lowest: Positive
    highest: Positive

    def __post_init__(self):
        """Check that there is a map for each number of samples."""
        shape = len(self.samples), len(self.x), len(self.y)
        for name in ("error", "below"):
            _checks.exact_shape(name, getattr(self, name), shape)

    @property
    def shown(self) -> FloatArray:
        """Published `error` with `lowest` in it where the error is only known to be below."""
        return np.where(self.below, self.lowest, self.error)


@checked
@record
class PublishedFigure6:
    """The curves of Fig 6, read off the paper's vector graphics.

    time (1001,): Time of each sample in s.
    error (1001, 3): Absolute position errors in m; NaN above the clipped axis where they cannot be
        known.
    nis (1001,): Normalized innovation squared.
    skipped (1001,): Samples at which the state was only predicted. The paper does not say so:
        inferred from the curves, and unknown (False) at the first sample.
    start (6,): Initial estimate that the drawn marker implies: its x in m, the rest as in Table 2.
    first_error (3,): Absolute position errors of the first sample in m; that of x from the 3-D
        view.
    path_time (50,): Times of the estimated positions drawn in the scene, from sample 21 on. The
        figure has one more at the first sample, for which the error curves cannot decide on the
        position.
    path (50, 3): These positions in m, inverted from the 3-D view with the help of the error
        curves.
    """

    time: Annotated[FloatArray, exactly(None)]
    error: Array
    nis: Array
    skipped: Booleans
    start: State
    first_error: Annotated[FloatArray, exactly(3)]
    path_time: Annotated[FloatArray, exactly(None)]
    path: Annotated[FloatArray, exactly(None, 3)]


@checked
@record
class PublishedFigure4:
    """The dots of Fig 4, read off the paper's vector graphics.

    variance (31,): Of the noise, in Hz^2.
    position, velocity (31, 20): Averaged errors in m and m/s, one column for each sequence in which
        they are drawn.
    """

    variance: Annotated[FloatArray, exactly(None)]
    position: Annotated[FloatArray, exactly(None, None, check=_checks.measured)]
    velocity: Annotated[FloatArray, exactly(None, None, check=_checks.measured)]


@checked
@record
class Reported:
    """All that the paper states and a computer can use.

    scenario: The simulation example of Section 4 and Table 2.
    table2: True initial state `x0` and estimate `x_ml`.
    quoted: Numbers that Section 4 quotes in words; units are in the names.
    signal_chain: What is said about the signal chain; units are in the names.
    figure3: The error maps.
    figure4_study: Settings of the study of Fig 4; under `ours` what the paper leaves open.
    figure4: Its dots.
    figure6: The curves of the example.
    sources: Where those stand that do not say it themselves.
    """

    scenario: Scenario
    table2: Published
    quoted: Published
    signal_chain: Published
    figure3: PublishedFigure3
    figure4_study: Published
    figure4: PublishedFigure4
    figure6: PublishedFigure6
    sources: dict[str, str]


@cache
def reported() -> Reported:
    """Return the values that the paper states.

    Examples
    --------
    >>> paper = reported()
    >>> paper.scenario.samples, paper.quoted.nis_avg, paper.quoted.where
    (1001, 5.82, 'Section 4, in words')
    """
    scenario = Scenario.from_toml(data_file("mittermaier2016", "scenario.toml"))
    printed = read_published(data_file("mittermaier2016", "table2.toml"))
    study = read_published(data_file("mittermaier2016", "figure4.toml"))
    return Reported(
        scenario=scenario,
        table2=printed.table2,
        quoted=printed.quoted,
        signal_chain=read_published(data_file("mittermaier2016", "signal_chain.toml")),
        figure3=_figure3(),
        figure4_study=study,
        figure4=_figure4(study.velocities.in_figure),
        figure6=_figure6(scenario.T, printed.table2.x_ml),
        sources=read_toml("mittermaier2016", "sources.toml"),
    )


def _figure3():
    settings = read_toml("mittermaier2016", "figure3.toml")
    array, sampling = dict(settings["array"]), settings["sampling"]
    if array.pop("shape") != "linear":
        raise ValueError("array in figure3.toml must have the shape linear")
    panels = [_table(f"fig3_{side}.csv") for side in ("left", "right")]
    x, y = np.unique(panels[0]["x_m"]), np.unique(panels[0]["y_m"])
    error, flag = (
        np.reshape([panel[name] for panel in panels], (len(panels), len(x), len(y)))
        for name in ("error_m", "flag")
    )
    return PublishedFigure3(
        x=x,
        y=y,
        error=error,
        below=flag == 2,
        array=RadarArray.linear(**array),
        velocity=np.array(settings["target"]["velocity"]),
        samples=tuple(sampling["samples"]),
        T=sampling["T"],
        sigma_f=sampling["sigma_f"],
        **settings["search"],
        **settings["drawing"],
    )


def _figure4(sequences):
    tables = [_table(f"fig4_{part}.csv") for part in ("position", "velocity")]
    variance, level = np.unique(tables[0]["variance_hz2"], return_inverse=True)
    dots = np.empty((2, len(variance), sequences))
    for values, table in zip(dots, tables, strict=True):
        values[level, table["series"].astype(int) - 1] = table["error"]
    return PublishedFigure4(variance, *dots)


def _figure6(T, x_ml):
    errors = _table("fig6_errors.csv")
    nis = _table("fig6_nis.csv")
    geometry = read_json("mittermaier2016", "fig6_geometry.json")
    initial, markers = geometry["initial"], geometry["estimated_path_markers"]["markers"]
    start = x_ml.copy()
    start[0] = initial["x_hat_implied_by_mle_marker_m"]["from_u"]
    return PublishedFigure6(
        time=(nis["sample"] - 1) * T,
        error=np.stack([errors[f"e{axis}_cm"] for axis in "xyz"], axis=-1) / 100,
        nis=nis["nis"],
        skipped=nis["update_skipped"] == 1,
        start=start,
        first_error=np.array([initial["sample1_abs_error_cm"][axis] / 100 for axis in "xyz"]),
        path_time=np.array([(marker["sample"] - 1) * T for marker in markers]),
        path=np.array([marker["est_position_m"] for marker in markers]),
    )


def _table(name):
    return np.genfromtxt(read_lines("mittermaier2016", name), delimiter=",", names=True)
