"""``warm``: make what is kept per user, the robots' models and the compiled kernels, so that first starts are quick."""

import argparse
import json
import time

from backend.experiments.trial import run_trial
from backend.knowledge.reachability import load_reachability
from backend.robots import ROBOTS
from backend.scenario import load_scenario, scenario_names, with_overrides

TIMEOUT = "timing.timeout_s=3.0"
"""A trial of so many simulated seconds passes through every kernel of its method."""
NO_STRAIGHT_WAY = "ur5_linear_slab"
"""A scenario in which planners have to plan."""


def run(options: argparse.Namespace) -> int:
    """Run the beginning of a trial with every robot and compiled planner, which makes what is missing; always 0."""
    took_s: dict[str, float] = {}
    for robot in ROBOTS:
        scenarios = (load_scenario(name) for name in scenario_names())
        scenario = next(scenario for scenario in scenarios if scenario.robot == robot)
        begun_s = time.perf_counter()
        load_reachability(robot)
        run_trial(with_overrides(scenario, [TIMEOUT]))
        took_s[robot] = round(time.perf_counter() - begun_s, 1)
        if not options.json:
            print(f"{robot} is ready after {took_s[robot]} s", flush=True)
    begun_s = time.perf_counter()
    for planner in ("fast", "chomp"):
        run_trial(with_overrides(load_scenario(NO_STRAIGHT_WAY), [f"method.planner.kind={planner}", TIMEOUT]))
    took_s["planners"] = round(time.perf_counter() - begun_s, 1)
    if not options.json:
        print(f"compiled planners are ready after {took_s['planners']} s", flush=True)
    if options.json:
        print(json.dumps({"took_s": took_s}))
    return 0
