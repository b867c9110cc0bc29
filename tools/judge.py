"""Judge the claims of every document, and write the judgments that the book shows.

results/NAME.verdicts.json appears when all claims of a document are judged; the verdict that its
file of claims states is not looked at. With --seeds nothing is written: the claims are judged with
each of these seeds, since no verdict may depend on the draw, and the exit code is 1 if one differs
from the one on record. Progress goes to standard error.
"""

import os
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from importlib import import_module
from itertools import starmap

import numpy as np

from dopplerlib._data import results
from dopplerlib._files import write_text
from dopplerlib.replication.claims import VERDICTS
from dopplerlib.replication.documents import documents, read_document
from dopplerlib.replication.judgments import judgments_text
from dopplerlib.replication.verdicts import judge_all
from tools.command import parser, start

SEED = 2016  # of the judgments that the book shows; any other would do, see --seeds


def evidence_of(document, seed):
    """Return the evidence for every claim, by its id, with one draw of all noise."""
    module = import_module(f"dopplerlib.systems.{document}.evidence")
    return module.evidence(rng=np.random.default_rng(seed))


def judgments(name, seed):
    """Return the judgments on every claim."""
    document = read_document(name)
    return judge_all(document.claims, evidence_of(name, seed), document.choices)


def verdicts(document, seed):
    """Return the verdict on every claim, by its id."""
    found = judgments(document, seed)
    return {one.claim.id: one.verdict for one in found if not one.claim.surrogate}


def written(name):
    """Judge a document, write its judgments, and return lines on verdicts that differ."""
    print(f"claims of {name} ...", file=sys.stderr, flush=True)
    found = judgments(name, SEED)
    write_text(results(f"{name}.verdicts.json"), judgments_text(found, SEED))
    return [
        f"{name}: {one.claim.id} is {one.verdict}, on record {one.claim.verdict}"
        for one in found
        if one.verdict != one.claim.verdict
    ]


def on_record(document):
    """Return the verdicts that the file of claims states; those on a surrogate do not count."""
    claims = read_document(document).claims
    return {claim.id: claim.verdict for claim in claims if not claim.surrogate}


def verdicts_by_seed(names, seeds, workers=None):
    """Return the verdicts by document, seed and claim; tell what is done.

    They are the same for any number of processes, by default one for each processor.
    """
    pairs = [(name, seed) for name in names for seed in seeds]
    found = {name: {} for name in names}
    workers = workers or os.cpu_count()
    with ProcessPoolExecutor(workers) if workers > 1 else nullcontext() as pool:
        each = pool.map(verdicts, *zip(*pairs, strict=True)) if pool else starmap(verdicts, pairs)
        for done, ((name, seed), verdict) in enumerate(zip(pairs, each, strict=True), 1):
            print(f"{done} of {len(pairs)}: {name}, seed {seed}", file=sys.stderr, flush=True)
            found[name][seed] = verdict
    return found


def table(found):
    """Return the lines of the table.

    `found` has the verdicts by document, seed and claim.
    """
    width = max(len(name) for name in ["document", *found])
    lines = [" ".join([f"{'document':{width}}", f"{'seed':>6}", *VERDICTS])]
    for document, by_seed in found.items():
        for seed, by_claim in by_seed.items():
            counts = Counter(by_claim.values())
            numbers = [f"{counts[verdict]:{len(verdict)}}" for verdict in VERDICTS]
            lines.append(" ".join([f"{document:{width}}", f"{seed:6}", *numbers]))
    return lines


def differences(found, record):
    """Return a line for every verdict that is not the one on record."""
    lines = []
    for document, by_seed in found.items():
        for seed, by_claim in by_seed.items():
            for claim in sorted(by_claim.keys() | record[document].keys()):
                here, there = by_claim.get(claim), record[document].get(claim)
                if here != there:
                    lines.append(f"{document}, seed {seed}: {claim} is {here}, on record {there}")
    return lines


def main(argv=None):
    """Judge, write or compare, print, and return the exit code."""
    options = parser(__doc__)
    options.add_argument("documents", nargs="*", help="all that have claims if none is named")
    options.add_argument("--seeds", type=int, nargs="+", help="compare only, with each of these")
    options.add_argument("--workers", type=int, help="processes; one for each processor by default")
    chosen = options.parse_args(argv)
    if not chosen.seeds:
        different = [line for name in chosen.documents or documents() for line in written(name)]
        print(*different, sep="\n", end="\n" * bool(different))
        return 1 if different else 0
    found = verdicts_by_seed(chosen.documents or documents(), chosen.seeds, chosen.workers)
    print(*table(found), sep="\n")
    differ = differences(found, {document: on_record(document) for document in found})
    print(*(differ or ["every verdict is the one on record"]), sep="\n")
    return 1 if differ else 0


if __name__ == "__main__":
    start(main)
