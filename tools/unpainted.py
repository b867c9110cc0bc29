"""A Matplotlib backend that draws figures and paints nothing, for the tests of the chapters.

Their pixels are compared with nothing; painting a figure and finding the place of its axes is four
fifths of what showing it costs. Errors and warnings come from what is left: ticks, texts and their
fonts. That its axes find their places is seen by the tests of `dopplerlib.figures`.
"""

from matplotlib import cbook
from matplotlib.backends.backend_agg import FigureCanvasAgg


class FigureCanvas(FigureCanvasAgg):
    """A canvas whose images are empty."""

    def print_png(self, filename, **kwargs):
        """Draw without paint, once, and with all axes where they are before they are laid out."""
        laid_out = self.figure.get_layout_engine() is not None
        if not laid_out or "draw" in vars(self.figure):  # Matplotlib asks for a renderer, and draws
            self.figure.set_layout_engine("none")
            with self.get_renderer()._draw_disabled():
                self.figure.draw(self.get_renderer())
        with cbook.open_file_cm(filename, "wb"):
            pass  # there is a file, which is empty
