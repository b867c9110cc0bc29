"""Judge the claims of every document with several seeds: no verdict may depend on the draw.

Prints how many claims of each document got which verdict, for each seed, and every claim whose
verdict is not the one on record. Progress goes to standard error. The exit code is
1 if there is one.
"""

import sys
from collections import Counter
from importlib import import_module

import numpy as np

from dopplerlib.replication.claims import VERDICTS
from dopplerlib.replication.documents import documents, read_document
from dopplerlib.replication.verdicts import judge_all
from tools.command import parser, start


def evidence_of(document, seed):
    """Return the evidence for every claim, by its id, with one draw of all noise."""
    module = import_module(f"dopplerlib.systems.{document}.evidence")
    return module.evidence(rng=np.random.default_rng(seed))


def verdicts(document, seed):
    """Return the verdict on every claim, by its id."""
    judgments = judge_all(read_document(document).claims, evidence_of(document, seed))
    return {one.claim.id: one.verdict for one in judgments if not one.claim.surrogate}


def on_record(document):
    """Return the verdicts that the file of claims states; those on a surrogate do not count."""
    claims = read_document(document).claims
    return {claim.id: claim.verdict for claim in claims if not claim.surrogate}


def verdicts_by_seed(names, seeds):
    """Return the verdicts by document, seed and claim; tell what is under way."""
    found, done = {name: {} for name in names}, 0
    for name in names:
        for seed in seeds:
            done += 1
            of_all = f"{done} of {len(names) * len(seeds)}"
            print(f"{of_all}: claims of {name}, seed {seed} ...", file=sys.stderr, flush=True)
            found[name][seed] = verdicts(name, seed)
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
    """Judge, print, and return the exit code."""
    options = parser(__doc__)
    options.add_argument("documents", nargs="*", help="all that have claims if none is named")
    options.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    chosen = options.parse_args(argv)
    found = verdicts_by_seed(chosen.documents or documents(), chosen.seeds)
    print(*table(found), sep="\n")
    differ = differences(found, {document: on_record(document) for document in found})
    print(*(differ or ["every verdict is the one on record"]), sep="\n")
    return 1 if differ else 0


if __name__ == "__main__":
    start(main)
