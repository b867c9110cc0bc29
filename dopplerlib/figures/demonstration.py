"""A drawing that moves under the reader's hands: HTML and JavaScript, without a server."""

import json
from importlib.resources import files

TEMPLATE = files(__package__) / "demonstration.html"


def doppler_demonstration(javascript, array, x):
    """Return the HTML of a plane scene with sliders, its Doppler shifts and iso-Doppler lines.

    Parameters
    ----------
    javascript : str
        Source of the function ``doppler_shift``, as `dopplerlib.derive.printers` prints it.
    array : RadarArray
        Sensors in the plane z = 0.
    x : array_like, shape (6,)
        State with which the scene starts, in m and m/s, in the plane z = 0.

    Returns
    -------
    str
        Loads nothing from elsewhere, and shows a sentence where JavaScript does not run.
    """
    settings = {
        "sensors": array.positions.round(6).tolist(),
        "dopplerPerSpeed": round(array.doppler_per_speed, 6),
        "x": [float(value) for value in x],
    }
    text = TEMPLATE.read_text(encoding="utf-8")
    return text.replace("/*SETTINGS*/", json.dumps(settings)).replace("/*FORMULA*/", javascript)
