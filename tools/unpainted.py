"""A Matplotlib backend that lays figures out and paints nothing, for the tests of the chapters.

Their pixels are compared with nothing, and painting takes a third of the time that a figure costs.
Errors and warnings come from what is left: ticks, texts, their fonts, and the layout.
"""

from matplotlib.backends.backend_agg import FigureCanvasAgg


class FigureCanvas(FigureCanvasAgg):
    """A canvas whose images are empty."""

    def print_png(self, filename, **kwargs):
        """Draw without paint, once: Matplotlib has done so if it had to lay the figure out."""
        laid_out = self.figure.get_layout_engine() is not None
        if not laid_out or "draw" in vars(self.figure):
            with self.get_renderer()._draw_disabled():
                self.figure.draw(self.get_renderer())
