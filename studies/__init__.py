"""Monte Carlo studies that take too long for a chapter: ``python -m studies NAME``.

One module a study. It has

``PARAMETERS``
    All that the results depend on beside code and data: seeds, numbers of runs, levels.
``FILES``
    How the names of its files go on after ``results/NAME``.
``parts()``
    Its calls of `run_study`: for each the settings beside the parameters, the number of runs, and
    how many of them are a chunk. A run is the smallest part of the work that has randomness of its
    own: a target that is tracked, or a cell of a table.
``compute(settings, seed, runs)``
    What `run_study` calls.
``contents(found)``
    The text or bytes of each file, given the results of all parts.

The first line of its docstring says what it computes, the next paragraph what it costs.
"""

import tools  # noqa: F401  (an interruption while a study is loaded ends it at once)
