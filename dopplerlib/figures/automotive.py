"""An automotive radar: its processing scheme, and what it makes of a scene."""

from .style import BOUND, ORANGE, OURS, PUBLISHED, SENSOR, TRUTH, styled


def scheme(blocks):
    """Draw a processing scheme as boxes in a row, with what goes in and out of each.

    Parameters
    ----------
    blocks : sequence of tuple (name, what comes out)
        From the first to the last; an empty name gives the input.

    Returns
    -------
    matplotlib.figure.Figure
    """
    with styled(7.0, 2.6) as figure:
        ax = figure.subplots()
        columns = 3
        for i, (name, out) in enumerate(blocks):
            row, column = divmod(i, columns)
            way = 1 if row % 2 == 0 else -1  # every other row runs back
            x, y = 1.1 * (column if way > 0 else columns - 1 - column), -row
            ax.text(
                x, y, name, ha="center", va="center", fontsize=9.5,
                bbox={"boxstyle": "round,pad=0.5", "fc": "#E8F1F8", "ec": OURS},
            )  # fmt: skip
            ax.text(x, y - 0.33, out, ha="center", va="center", fontsize=8.5, color="#555555")
            if i + 1 < len(blocks):
                ends = ((x + 0.42 * way, y), (x + 0.68 * way, y))
                if column == columns - 1:
                    ends = ((x, y - 0.43), (x, y - 0.75))
                ax.annotate("", ends[1], ends[0], arrowprops={"arrowstyle": "->", "color": BOUND})
        ax.set(xlim=(-0.55, 2.75), ylim=(-1.45, 0.3))
        ax.axis("off")
        return figure


def scene(stages, truth):
    """Draw detections and tracks from above, one panel for each stage.

    Parameters
    ----------
    stages : dict of str to dict of str to ndarray, shape (..., 2)
        For each title and each label, positions [x, y] in m. Labels that begin with "track" are
        drawn as lines, and named once.
    truth : ndarray, shape (K, 4)
        True states of the target.

    Returns
    -------
    matplotlib.figure.Figure
    """
    dots = {"target": OURS, "stands still": BOUND, "false alarm": ORANGE, "object": SENSOR}
    with styled(7.0, 3.8) as figure:
        axes = figure.subplots(1, len(stages), sharex=True, sharey=True, squeeze=False)[0]
        for ax, (title, groups) in zip(axes, stages.items(), strict=True):
            named = False
            for label, xy in groups.items():
                if label.startswith("track"):
                    ax.plot(*xy.T, color=PUBLISHED, lw=1.6, label=None if named else "track")
                    named = True
                else:
                    ax.plot(*xy.T, ".", ms=2, color=dots[label], alpha=0.5, label=label)
            ax.plot(truth[:, 0], truth[:, 2], color=TRUTH, ls="--", lw=1, label="truth")
            ax.plot(0, 0, "^", color=TRUTH, ms=7)
            ax.set(title=title, xlabel="x in m")
            ax.legend(loc="upper left", fontsize=8, markerscale=3, framealpha=0.9, frameon=True)
        axes[0].set(ylabel="y in m", ylim=(-2, 85))
        return figure
