"""Measure grasps of a belt that changes: ``python -m tests.measure_live [--seeds 24] [--scenarios NAME ...] [--json]``.

In whole trials the belt's rate is changed in the moment in which the hand begins to go in, the worst there is: a belt
that turns round, stops, slows down or speeds up. The object must be grasped before the belt has come to its end.
"""

from __future__ import annotations

import argparse
import json
import sys

from backend.episode import Episode
from backend.events import SetBeltRate
from backend.scenario import load_scenario

RATES = (-1.0, 0.0, 0.5, 2.0)
SCENARIOS = ("mico_linear", "ur5_linear", "mico_circular", "ur5_sinusoidal")


def grasped(scenario: str, seed: int, rate: float) -> bool:
    """Whether a trial succeeds though the belt changes to ``rate`` as the hand goes in."""
    with Episode(load_scenario(scenario), seed) as episode:
        changed, outcome = False, None
        for snapshot in episode.run():
            if snapshot.phase == "approach" and not changed:
                episode.apply(SetBeltRate(rate=rate))
                changed = True
            outcome = snapshot.outcome
    return outcome is not None and outcome.strict


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.measure_live", description=__doc__)
    parser.add_argument("--seeds", type=int, default=24, metavar="N", help="trials of each kind (default 24)")
    parser.add_argument("--scenarios", nargs="+", default=SCENARIOS, metavar="NAME", help=f"default {SCENARIOS}")
    parser.add_argument("--json", action="store_true", help="print figures instead of a table")
    options = parser.parse_args(argv)
    counts = {
        name: {rate: sum(grasped(name, seed, rate) for seed in range(options.seeds)) for rate in RATES}
        for name in options.scenarios
    }
    if options.json:
        print(json.dumps({"seeds": options.seeds, "grasped": counts}))
        return 0
    print(f"Grasped of {options.seeds}, the belt's rate changed from 1 as the hand goes in\n")
    print("| scenario | " + " | ".join(f"{rate:g}" for rate in RATES) + " |")
    print("|---|" + "---|" * len(RATES))
    for name, by_rate in counts.items():
        print(f"| {name} | " + " | ".join(str(count) for count in by_rate.values()) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
