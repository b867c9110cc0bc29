"""Many detections and many targets: gates, association, and the life of a track."""

from .._lazy import attach

__getattr__, __dir__ = attach(__name__, __path__)
