"""Progress of long work, on standard error."""

import sys
import time


def progress_bar(items, label, wanted=True):
    """Yield items and show on standard error how many are done and how long the rest takes.

    items: Each of them should take about the same time.
    label: What stands before the bar.
    wanted: Whether there is a bar.
    Yields: The items.
    """
    start = time.monotonic()
    for done, item in enumerate(items):
        if wanted:
            spent = time.monotonic() - start
            left = f"{spent / done * (len(items) - done):.0f} s left" if done else ""
            _draw(label, done / len(items), left)
        yield item
    if wanted:
        _draw(label, 1.0, "")
        sys.stderr.write("\n")


def _draw(label, share, left):
    full = round(30 * share)
    # Spaces at the end cover what a longer line has left.
    sys.stderr.write(f"\r{label} [{'#' * full}{'.' * (30 - full)}] {share:4.0%} {left:12}")
    sys.stderr.flush()
