"""Try many odd arguments on every public function, with other ones each time: ``make fuzz``."""

import argparse
import secrets
import sys
import time
from collections import Counter

from .run import fuzz
from .targets import PACKAGES, discover


def main():
    options = _options()
    targets = [t for package in PACKAGES for t in discover(f"dopplerlib.{package}")]
    chosen = [t for t in targets if options.only in t.name and t.name >= options.start]
    print(f"seed {options.seed}: {len(chosen)} functions, {options.calls} calls of each")
    total, faults = Counter(), []
    for place, target in enumerate(sorted(chosen, key=lambda each: each.name), 1):
        begun = time.monotonic()
        try:
            outcome = fuzz(target, options.calls, options.seed)
        except KeyboardInterrupt:
            print(f"\ngo on with FUZZ_SEED={options.seed} FUZZ_FROM={target.name}", file=sys.stderr)
            break
        total += outcome.counts
        faults += outcome.bad
        counts = ", ".join(f"{key} {outcome.counts[key]}" for key in ("refused", "taken", "bad"))
        seconds = time.monotonic() - begun
        print(f"{place}/{len(chosen)} {target.name}: {counts}; {seconds:.0f} s", file=sys.stderr)
        for text in outcome.bad:
            print(text, flush=True)
    print(
        f"{sum(total.values())} calls: {total['refused']} refused by name, {total['taken']} taken, "
        f"{total['bad']} bad in {len(faults)} kinds (seed {options.seed})"
    )
    return bool(faults)


def _options():
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("only", nargs="?", default="", help="part of a function's name")
    parser.add_argument("-n", "--calls", type=int, default=10_000, help="of each function")
    parser.add_argument("--seed", type=int, default=secrets.randbelow(2**32))
    parser.add_argument("--from", dest="start", default="", help="the function to begin with")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
