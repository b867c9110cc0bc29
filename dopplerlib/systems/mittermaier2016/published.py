"""What the paper prints and draws, from ``data/mittermaier2016``."""

from functools import partial

import numpy as np

from ..._data import data, read_json, read_lines, read_toml
from ..._records import record
from ...model.radar_array import RadarArray
from ...model.scenario import Scenario

data_file = partial(data, "mittermaier2016")


@record
class Table2:
    """The start of the simulation example as Table 2 prints it.

    Attributes
    ----------
    x0 : ndarray, shape (6,)
        True initial state in m and m/s.
    x_ml : ndarray, shape (6,)
        Estimate from ten samples by maximum likelihood.
    """

    x0: np.ndarray
    x_ml: np.ndarray


@record
class PublishedFigure3:
    """The two error maps of Fig 3, read off a pixel image, and the settings that go with them.

    The first axis of a map is x, upwards in the figure; the second is y, to the right.

    Attributes
    ----------
    x, y : ndarray, shape (39,)
        Places in m.
    error : ndarray, shape (2, 39, 39)
        Errors in m, one map for each entry of `samples`; NaN where not known.
    below : ndarray of bool, shape (2, 39, 39)
        Where the error is only known to be below `lowest`.
    array : RadarArray
        Sensors as the figure draws them.
    velocity : ndarray, shape (3,)
        Of the target in m/s, the same at every place.
    samples : tuple of int
        Number of samples behind each map.
    T, sigma_f : float
        Sampling interval in s, standard deviation of the Doppler shifts in Hz.
    top_speed : float
        Speed of the drives in m/s, to which the search is restricted.
    lowest, highest : float
        First and last contour in m.
    """

    x: np.ndarray
    y: np.ndarray
    error: np.ndarray
    below: np.ndarray
    array: RadarArray
    velocity: np.ndarray
    samples: tuple
    T: float
    sigma_f: float
    top_speed: float
    lowest: float
    highest: float

    @property
    def shown(self):
        """Return `error` with `lowest` in it where the error is only known to be below."""
        return np.where(self.below, self.lowest, self.error)


@record
class PublishedFigure6:
    """The curves of Fig 6, read off the paper's vector graphics.

    Attributes
    ----------
    time : ndarray, shape (1001,)
        Time of each sample in s.
    error : ndarray, shape (1001, 3)
        Absolute position errors in m; NaN above the clipped axis where they cannot be known.
    nis : ndarray, shape (1001,)
        Normalized innovation squared.
    skipped : ndarray of bool, shape (1001,)
        Samples at which the state was only predicted. The paper does not say so: inferred from
        the curves, and unknown (False) at the first sample.
    start : ndarray, shape (6,)
        Initial estimate that the drawn marker implies: its x in m, the rest as in Table 2.
    first_error : ndarray, shape (3,)
        Absolute position errors of the first sample in m; that of x from the 3-D view.
    path_time : ndarray, shape (50,)
        Times of the estimated positions drawn in the scene, from sample 21 on. The figure has one
        more at the first sample, for which the error curves cannot decide on the position.
    path : ndarray, shape (50, 3)
        These positions in m, inverted from the 3-D view with the help of the error curves.
    """

    time: np.ndarray
    error: np.ndarray
    nis: np.ndarray
    skipped: np.ndarray
    start: np.ndarray
    first_error: np.ndarray
    path_time: np.ndarray
    path: np.ndarray


@record
class PublishedFigure4:
    """The dots of Fig 4, read off the paper's vector graphics.

    Attributes
    ----------
    variance : ndarray, shape (31,)
        Of the noise, in Hz^2.
    position, velocity : ndarray, shape (31, 20)
        Averaged errors in m and m/s, one column for each sequence in which they are drawn.
    """

    variance: np.ndarray
    position: np.ndarray
    velocity: np.ndarray


def scenario():
    """Return the simulation example of Section 4 and Table 2.

    Returns
    -------
    Scenario
    """
    return Scenario.from_toml(data_file("scenario.toml"))


def table2():
    """Return the two states that Table 2 prints.

    Returns
    -------
    Table2
    """
    printed = read_json("mittermaier2016", "table2.json")
    names = ("x", "y", "z", "vx", "vy", "vz")
    return Table2(
        *(
            np.array([printed[key][name] for name in names])
            for key in ("true_initial_state", "estimated_initial_state_mle")
        )
    )


def published_figure3():
    """Return the digitized error maps of Fig 3.

    Returns
    -------
    PublishedFigure3
    """
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


def published_figure6():
    """Return the digitized curves of Fig 6.

    Returns
    -------
    PublishedFigure6
    """
    T = scenario().T
    errors = _table("fig6_errors.csv")
    nis = _table("fig6_nis.csv")
    geometry = read_json("mittermaier2016", "fig6_geometry.json")
    initial, markers = geometry["initial"], geometry["estimated_path_markers"]["markers"]
    start = table2().x_ml.copy()
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


def published_figure4():
    """Return the digitized dots of Fig 4.

    Returns
    -------
    PublishedFigure4
    """
    tables = [_table(f"fig4_{part}.csv") for part in ("position", "velocity")]
    variance, level = np.unique(tables[0]["variance_hz2"], return_inverse=True)
    dots = np.empty((2, len(variance), figure4_settings()["velocities"]["in_figure"]))
    for values, table in zip(dots, tables, strict=True):
        values[level, table["series"].astype(int) - 1] = table["error"]
    return PublishedFigure4(variance, *dots)


def figure4_settings():
    """Return the settings of the study of Fig 4, by name.

    Returns
    -------
    dict
        See ``data/mittermaier2016/figure4.toml``; under ``ours`` what the paper leaves open.
    """
    return read_toml("mittermaier2016", "figure4.toml")


def signal_chain():
    """Return what the paper says about its signal chain, by name.

    Returns
    -------
    dict
        Units are in the names; see ``data/mittermaier2016/signal_chain.toml``.
    """
    return read_toml("mittermaier2016", "signal_chain.toml")


def quoted():
    """Return the numbers that Table 2 and Section 4 quote in words, by name.

    Returns
    -------
    dict
        Units are in the names; see ``data/mittermaier2016/README.md``.
    """
    return read_json("mittermaier2016", "table2.json")["quoted"]


def _table(name):
    return np.genfromtxt(read_lines("mittermaier2016", name), delimiter=",", names=True)
