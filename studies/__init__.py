"""Monte Carlo studies that take too long for a chapter: ``python -m studies NAME``.

One module a study. It has

``PARAMETERS``
    All that the results depend on beside code and data: seeds, numbers of runs, levels.
``FILES``
    How the names of its files go on after ``results/NAME``.
``items()``
    Parts of the work that are saved one by one.
``rows(items)``
    What JSON can hold of each of these items, one after the other.
``contents(rows)``
    The bytes of each file, given the rows of all items.

The first line of its docstring says what it computes, the next paragraph what it costs.
"""

import tools  # noqa: F401  (an interruption while a study is loaded ends it at once)
