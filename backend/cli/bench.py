"""``bench``: wall time of each room, bare stepping rate of the same world, and what a trial takes beside it.

``bench motion`` and ``bench lifts`` have a file of their own.
"""

import argparse
import json
import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.machine import machine
from backend.pipeline.values import Room
from backend.scenario import Scenario, load_scenario, with_overrides
from backend.sim.world import World


def run(options: argparse.Namespace) -> int:
    """Print times and ratios, all from one run on this machine; always 0."""
    if options.what != "rooms":
        from backend.cli import bench_figures

        return bench_figures.run(options)
    if options.trials < 1:
        raise InvalidInputError(f"--trials must be at least 1 (got {options.trials})")
    scenario = load_scenario(options.scenario)
    rooms = _rooms(with_overrides(scenario, ["timing.think=budget"]), options.trials)
    ratio = _ratio(with_overrides(scenario, ["timing.think=paper"]), options.trials)
    table: dict[str, Any] = {"machine": machine(), "scenario": options.scenario, "rooms": rooms, **ratio}
    if options.json:
        print(json.dumps(table))
        return 0
    print(f"{table['machine']}; {options.scenario}, {options.trials} trials")
    for room, line in rooms.items():
        print(f"  {room:<10} median {line['median_ms']:7.2f} ms   95 % within {line['p95_ms']:7.2f} ms")
    print(f"  bare stepping {ratio['bare_steps_per_s']:.0f} steps/s")
    print(
        f"  a whole trial, `paper` charge: {ratio['trial_to_bare']:.2f} x bare stepping of as many steps, arm at rest,"
    )
    print(f"  {ratio['trial_to_stepping']:.2f} x the stepping of its own world in it")
    return 0


def _rooms(scenario: Scenario, trials: int) -> dict[str, dict[str, float]]:
    """Median and 95th percentile of every room and of whole cycles, over all cycles of some trials."""
    times: dict[Room | str, list[float]] = {}
    for seed in range(trials):
        with Episode(scenario, seed) as episode:
            number = -1
            for snapshot in episode.run():
                cycle = snapshot.cycle
                if cycle is not None and cycle.number != number:
                    number = cycle.number
                    for room, room_s in cycle.room_s.items():
                        times.setdefault(room, []).append(room_s)
                    if cycle.trajectory is not None:
                        times.setdefault("cycle", []).append(sum(cycle.room_s.values()))
    return {
        room: {"median_ms": 1e3 * float(np.median(t)), "p95_ms": 1e3 * float(np.percentile(t, 95))}
        for room, t in times.items()
    }


def _ratio(scenario: Scenario, trials: int) -> dict[str, float]:
    """Wall time of unseen trials from first to last step, against the stepping of their worlds, turn by turn.

    Bare stepping is nothing but physics, as many steps with the arm held still; stepping in the trial is what the same
    trial spends in its own steps, in which the hand goes in, touches and lifts: contacts cost physics twice as much.
    """
    trial_s = bare_s = stepping_s = 0.0
    steps = 0
    for seed in range(trials):
        with Episode(scenario, seed) as episode:
            stepping = _Stopwatch(episode.world)
            begun_s = time.perf_counter()
            episode.finish()
            trial_s += time.perf_counter() - begun_s
            stepping_s += stepping.total_s
            done = episode.world.steps
        with Episode(scenario, seed) as episode:
            q = episode.world.q().tolist()
            begun_s = time.perf_counter()
            episode.world.step_bare(q, [0.0] * len(q), done)
            bare_s += time.perf_counter() - begun_s
        steps += done
    return {
        "bare_steps_per_s": steps / bare_s,
        "trial_to_bare": trial_s / bare_s,
        "trial_to_stepping": trial_s / stepping_s,
        "trials": float(trials),
    }


class _Stopwatch:
    """Adds up what a world spends in its steps."""

    def __init__(self, world: World) -> None:
        self.total_s = 0.0
        self._step = world.step
        world.step = self._timed

    def _timed(self, q: Sequence[float], qd: Sequence[float]) -> None:
        begun_s = time.perf_counter()
        self._step(q, qd)
        self.total_s += time.perf_counter() - begun_s
