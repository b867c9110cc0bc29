"""What drawings of scenes share: a view of space, arrows, labels, colors of sensors."""

import numpy as np

# Sensors in their order, all of the hue that means "sensor": dark to light, and labeled as well.
_SHADES = ("#00382A", "#005B44", "#007A5B", "#009E73", "#45B894", "#7CCDB2")
LABEL = {"textcoords": "offset points", "ha": "center", "va": "center"}
HALO = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}


def sensor_colors(n):
    """Return `n` colors for sensors 1 to n, from dark to light."""
    return [_SHADES[i * len(_SHADES) // n] for i in range(n)]


def project(points, azimuth, elevation):
    """Return the orthographic view of `points`, shape (..., 3), as (..., 2): right and up.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Positions in m, z upwards.
    azimuth, elevation : float
        From where they are seen, in degrees; azimuth from +x towards +y.
    """
    a, e = np.deg2rad([azimuth, elevation])
    right = [-np.sin(a), np.cos(a), 0]
    up = [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)]
    return np.asarray(points) @ np.transpose([right, up])


def spread(values, gap):
    """Return `values` moved apart as little as needed so that no two are closer than `gap`.

    Labels at the ends of neighboring curves would otherwise cover each other.
    """
    values = np.asarray(values, float)
    order = np.argsort(values, kind="stable")
    moved = values[order]
    for _ in range(100 * len(moved)):
        short = gap - np.diff(moved)
        if (short <= 1e-9 * gap).all():
            break
        push = np.maximum(short, 0) / 2
        moved[:-1] -= push
        moved[1:] += push
    result = np.empty_like(moved)
    result[order] = moved
    return result


def arrow(ax, start, vector, color, text, offset=(0, 10)):
    """Draw an arrow from `start` along `vector`, with `text` at its middle, `offset` points off."""
    end = np.add(start, vector)
    style = {"arrowstyle": "-|>", "lw": 2, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 13}
    ax.annotate("", end, start, arrowprops={**style, "color": color})
    ax.annotate(text, (np.asarray(start) + end) / 2, offset, color=color, bbox=HALO, **LABEL)
