"""A figure that is drawn and not painted tells what a painted one would."""

import io

import pytest
from matplotlib.figure import Figure


@pytest.mark.parametrize("layout", [None, "constrained"])
def test_nothing_is_painted_and_a_missing_letter_is_told(layout):
    figure, file = Figure(layout=layout), io.BytesIO()
    axes = figure.subplots()
    axes.plot([1, 2])
    figure.savefig(file, format="png", backend="module://tools.unpainted")
    assert file.getvalue() == b""
    axes.set_title("\N{GOTHIC LETTER AHSA}")
    with pytest.warns(UserWarning, match="Glyph 66352 .* missing from font"):
        figure.savefig(file, format="png", backend="module://tools.unpainted")


@pytest.mark.parametrize("layout", [None, "constrained"])
def test_an_error_of_an_artist_is_raised(layout):
    figure = Figure(layout=layout)
    figure.text(0.5, 0.5, "$\\no$")
    with pytest.raises(ValueError, match="Unknown symbol"):
        figure.savefig(io.BytesIO(), format="png", backend="module://tools.unpainted")
