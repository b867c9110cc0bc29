"""Track management: tentative, confirmed and deleted tracks (M of N)."""

from functools import partial
from typing import Annotated, Literal

from .. import _checks
from .._hints import Count, Index, checked
from .._records import record

Status = Literal["tentative", "confirmed", "deleted"]
Life = tuple[Status, tuple[bool, ...], int, int]  # the fields of `TrackLife`
TENTATIVE: Status = "tentative"
CONFIRMED: Status = "confirmed"
DELETED: Status = "deleted"


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

    status: Status
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
        return TrackLife(*_begun(self))

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
        return TrackLife(
            *_advanced(self, life.status, life.recent, life.age, life.misses, detected)
        )


def _begun(manager: TrackManager) -> Life:
    """Return the fields of the status of a new track, unchecked: a tracker has thousands."""
    return CONFIRMED if manager.hits == 1 else TENTATIVE, (True,), 1, 0


def _advanced(
    manager: TrackManager,
    status: Status,
    recent: tuple[bool, ...],
    age: int,
    misses: int,
    detected: bool,
) -> Life:
    """Return the fields of the status of a track after one more scan, unchecked."""
    if status == DELETED:
        return status, recent, age, misses
    recent = (*recent, detected)[-manager.window :]
    misses = 0 if detected else misses + 1
    age += 1
    if status == CONFIRMED:
        status = DELETED if misses >= manager.delete_after else CONFIRMED
    elif sum(recent) >= manager.hits:
        status = CONFIRMED
    elif age >= manager.window:
        status = DELETED
    return status, recent, age, misses
