"""Track management: tentative, confirmed and deleted tracks (M of N)."""

from functools import partial
from typing import Annotated, Literal

from .. import _checks
from .._hints import Count, Index, checked
from .._records import record

TENTATIVE, CONFIRMED, DELETED = "tentative", "confirmed", "deleted"


@checked
@record
class TrackLife:
    """Status and detection history of a track.

    Attributes
    ----------
    status : {"tentative", "confirmed", "deleted"}
        Status of the track.
    recent : tuple of bool
        Whether it was detected in each of the last scans, up to the window of its manager.
    age : int
        Number of scans since the detection that started it, which counts as one.
    misses : int
        Number of scans in a row without a detection.
    """

    status: Literal["tentative", "confirmed", "deleted"]
    recent: Annotated[tuple[bool, ...], partial(_checks.some_of, choices=(True, False))]
    age: Count
    misses: Index


@checked
@record
class TrackManager:
    """Rules for the confirmation and deletion of tracks.

    Parameters
    ----------
    hits, window : int
        A tentative track is confirmed once it has `hits` detections among the last `window` scans
        ("M of N"). It is deleted when it is `window` scans old and still not confirmed.
    delete_after : int
        Number of scans in a row without a detection after which a confirmed track is deleted.

    Notes
    -----
    Blackman and Popoli (1999) treat this rule, M of N, beside others.

    Examples
    --------
    >>> manager = TrackManager(hits=2, window=3, delete_after=2)
    >>> life = manager.start()
    >>> for detected in (False, True, False, False):
    ...     life = manager.advance(life, detected)
    ...     print(life.status)
    tentative
    confirmed
    confirmed
    deleted
    """

    hits: Count
    window: Count
    delete_after: Count

    def __post_init__(self):
        """Check the rules."""
        if self.hits > self.window:
            raise ValueError(f"hits must be at most window = {self.window}, got {self.hits}")

    def start(self) -> TrackLife:
        """Return the status of a new track, after its first detection.

        Returns
        -------
        TrackLife
        """
        status = CONFIRMED if self.hits == 1 else TENTATIVE
        return TrackLife(status, recent=(True,), age=1, misses=0)

    @checked
    def advance(self, life: TrackLife, detected: bool) -> TrackLife:
        """Return the status of a track after one more scan.

        Parameters
        ----------
        life : TrackLife
            Before the scan.
        detected : bool
            Whether the scan had a detection for this track.

        Returns
        -------
        TrackLife
            Once deleted, a track stays so.
        """
        if life.status == DELETED:
            return life
        recent = (*life.recent, detected)[-self.window :]
        misses = 0 if detected else life.misses + 1
        age, status = life.age + 1, life.status
        if status == CONFIRMED:
            status = DELETED if misses >= self.delete_after else CONFIRMED
        elif sum(recent) >= self.hits:
            status = CONFIRMED
        elif age >= self.window:
            status = DELETED
        return TrackLife(status, recent, age, misses)
