"""Evidence on the bilaterated position."""

import numpy as np

from ....replication.evidence import Draws, Readings
from ..measures import position_errors, usable_range, usable_ratio
from ..position_tracker import clipped_bilateration
from ..published import reported
from ._ranges import error_ratio


def found(records, tracks, rng):
    """Return the evidence by the id of the claim; `tracks` are those of `_ranges.filtered`."""
    records = records.until(reported().scenario.tracks.duration)
    t, truth, d = records.time, records.truth, records.distance

    def position_error(d1, d2):
        p, _ = clipped_bilateration(d1[:, : len(t)], d2[:, : len(t)], records.baseline)
        return position_errors(p, truth[: p.shape[1]]), p

    errors = {name: position_error(*np.moveaxis(track.x[..., 0], 1, 0))[0]
              for name, track in tracks.items()}  # fmt: skip
    errors["measured"], raw = position_error(*np.moveaxis(records.z[..., 0], 1, 0))
    inside = tracks["code"].updated[:, :, : len(t)].all(axis=1)
    errors["inside the gate"] = np.where(inside, errors["measured"], np.nan)
    single = tracks["code"].x[:, 0, : len(t), 0] - records.ranges[0, :, 0]
    at = int(np.argmin(np.hypot(*(truth[:, :2] - reported().quoted.range.compared).T)))

    def of_each(name, low, high, value="root mean square"):
        # From here to there, seen from the origin.
        some = errors[name][:, (d >= low) & (d <= high)]
        largest = value == "largest"
        return Draws(some.max(axis=1) if largest else np.sqrt(np.mean(some**2, axis=1)))

    def ratio(a, b, low, high):
        return error_ratio(errors[a], errors[b], t, low, high, rng)

    return {
        "useful-range": Draws(np.minimum(usable_range(errors["code"][:, None], t, d), d[-1])),
        "raw-range": usable_ratio(errors["measured"], errors["code"], t, d, rng=rng),
        "fusion-shortens": usable_ratio(errors["code"], single, t, d, rng=rng),
        "raw-at-four": Draws(np.abs(raw[:, at, 0] - truth[at, 0])),
        "raw-near-simulated": Readings(
            {
                f"{value} from 2 to 3 m": of_each("measured", 2, 3, value)
                for value in ("root mean square", "largest")
            }
        ),
        "raw-beyond-four": Readings(
            {
                f"{name}, {low} to {high} m": of_each(track, low, high)
                for name, track, low, high in (
                    ("measured", "measured", 4.4, 4.7),
                    ("measured", "measured", 5, 5.66),
                    ("estimated", "code", 4.4, 4.7),
                )
            }
        ),
        "error-at-four-simulated": Readings(
            {
                name: of_each(track, 3.9, 4.1)
                for name, track in (("measured", "measured"), ("estimated", "code"))
            }
        ),
        "tweaked": usable_ratio(errors["modern"], errors["code"], t, d, rng=rng),
        "gate-triangulation": ratio("code, no gate", "code", 44, 46),
        "gate-triangulation-text": ratio("text, no gate", "text", 44, 46),
        "gate-measurements": ratio("measured", "inside the gate", 44, 46),
        "doppler-position": ratio("code", "code, no rate", 25, 40),
    }
