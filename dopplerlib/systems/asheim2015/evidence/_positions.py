"""Evidence on the bilaterated position."""

import numpy as np

from ....replication.evidence import Draws, sweep
from ..measures import position_errors, usable_range, usable_ratio
from ..position_tracker import clipped_bilateration
from ..published import reported
from ._ratios import choices, ratio, within


def found(records, tracks, rng):
    """Return the evidence by the id of the claim; `tracks` are those of `_ranges.filtered`."""
    records = records.until(reported().scenario.tracks.duration)
    t, truth, d = records.time, records.truth, records.distance
    K = len(t)

    def bilaterated(ranges):
        p, _ = clipped_bilateration(ranges[:, 0, :K], ranges[:, 1, :K], records.baseline)
        return p

    raw = bilaterated(records.z[..., 0])
    errors = {key: position_errors(bilaterated(track.x[..., 0]), truth)
              for key, track in tracks.items()}  # fmt: skip
    errors["measured"] = position_errors(raw, truth)
    paths = {"measured": errors["measured"], "estimated": errors["code", "box", True]}

    def off(error, at, read_off):
        some = error[:, at]
        root = read_off == "root mean square"
        return Draws(np.sqrt(np.mean(some**2, axis=1)) if root else some.max(axis=1))

    def useful(settings, accuracy, average):
        each = errors[settings, "box", True][:, None]
        return Draws(np.minimum(usable_range(each, t, d, accuracy, average), d[-1]))

    def reach(child, settings, accuracy, average):
        estimated = errors[settings, "box", True]
        single = tracks[settings, "box", True].x[:, 0, :K, 0] - records.ranges[0, :, 0]
        modern = errors["modern", "nis", True]

        few = len(modern)

        def over(a, b):
            return usable_ratio(a[:few], b[:few], t, d, accuracy, average, rng=child)

        return {
            "raw-range": over(errors["measured"], estimated),
            "fusion-shortens": over(estimated, single),
            "tweaked": over(modern, estimated),
        }

    def late(child, settings, end, metric):
        at = within(t, end)
        gated, free = (errors[settings, gate, True][:, at] for gate in ("box", "none"))
        measured = errors["measured"][:, at]
        passed = tracks[settings, "box", True].updated[:, :, :K].all(axis=1)[:, at]
        inside = np.where(passed, measured, np.nan)
        return {
            "gate-triangulation": ratio(free, gated, metric, child),
            "gate-measurements": ratio(measured, inside, metric, child),
        }

    def rate(child, settings, gate, part, metric):
        at = within(t, part)
        return ratio(*(errors[settings, gate, doppler][:, at] for doppler in (True, False)),
                     metric, child)  # fmt: skip

    def compared(half, read_off):
        x = np.abs(raw[..., 0] - truth[:, 0])
        return off(
            x, np.hypot(*(truth[:, :2] - reported().quoted.range.compared).T) <= half, read_off
        )

    return {
        "useful-range": sweep(choices("settings", "accuracy", "average"), useful),
        **sweep(choices("settings", "accuracy", "average"), reach, rng),
        **sweep(choices("settings", "end", "metric"), late, rng),
        "doppler-position": sweep(choices("settings", "gate", "part", "metric"), rate, rng),
        "raw-at-four": sweep(choices("at-four", "read-off"), compared),
        "raw-near-simulated": sweep(
            choices("read-off"), lambda how: off(paths["measured"], within(d, "2 to 3 m"), how)
        ),
        "raw-beyond-four": sweep(
            choices("path", "beyond-four", "read-off"),
            lambda path, window, how: off(paths[path], within(d, window), how),
        ),
        "error-at-four-simulated": sweep(
            choices("path", "at-four", "read-off"),
            lambda path, half, how: off(paths[path], np.abs(d - 4) <= half, how),
        ),
    }
