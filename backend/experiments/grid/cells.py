"""Cells: from settings to the trials, each with a key, a scenario and a seed, in the order they are run."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

from pydantic import ValidationError

from backend.errors import InvalidInputError, NotFoundError
from backend.experiments.grid.settings import GridSettings
from backend.methods import METHODS, Method
from backend.objects import OBJECTS
from backend.scenario import Scenario, load_scenario, scenario_names, with_overrides
from backend.tasks.start import Start

DECIDED_BY_THE_GRID = (
    *("robot", "object", "method", "method.name", "method.title", "profile", "seed", "title", "description"),
    *("timing.think", "task.kind"),
)
"""Not for ``set``: the grid's own words say them, or they are not conditions."""
OF_NO_EFFECT = {"title", "description", "object", "seed", "start"}
"""What a cell's scenario has beyond its conditions."""

ANY_OBJECT = next(iter(OBJECTS))

Group = tuple[str, str, str]
"""Robot, task and object: trials with the same index in one group begin identically."""


@dataclass(frozen=True, order=True)
class Key:
    """Which trial of a grid."""

    robot: str
    task: str
    object: str
    method: str
    index: int

    def __str__(self) -> str:
        return f"{self.robot}/{self.task}/{self.object}/{self.method}/{self.index}"

    @staticmethod
    def parse(text: str) -> Key:
        """The key that prints as ``text``; raises ``InvalidInputError``."""
        parts = text.strip().split("/")
        if len(parts) != 5 or not parts[4].isdecimal():
            raise InvalidInputError(
                f"{text!r} is not the key of a trial; keys are ROBOT/TASK/OBJECT/METHOD/INDEX, "
                "such as ur5_robotiq/linear/cube/ours_rm/17."
            )
        robot, task, object, method, index = parts
        return Key(robot, task, object, method, int(index))


@dataclass(frozen=True, eq=False)
class Job:
    """One trial to run, with all that a worker needs."""

    key: Key
    scenario: Scenario
    seed: int


Beginning = tuple[int, Start | None]
"""Seed and, where a trial set says it, how the trial begins; None: drawn from the seed."""


@dataclass(frozen=True, eq=False)
class Plan:
    """All trials of a grid."""

    settings: GridSettings
    scenarios: Mapping[tuple[str, str, str], Scenario]
    """Robot, task, method -> the scenario, whose object, seed and start are replaced by each trial's."""
    starts: Mapping[Group, tuple[Beginning, ...]]

    @property
    def groups(self) -> list[Group]:
        return list(self.starts)

    @property
    def trials(self) -> int:
        return len(self.settings.methods) * sum(map(len, self.starts.values()))

    def decided(self) -> dict[str, Any]:
        """Settings and whole conditions, as a plain table: what rows depend on besides the code."""
        conditions = {
            "/".join(cell): scenario.model_dump(mode="json", exclude=OF_NO_EFFECT)
            for cell, scenario in self.scenarios.items()
        }
        return {**self.settings.deciding(), "conditions": conditions}

    def jobs(self, wanted: Callable[[Key], bool], shard: tuple[int, int] = (1, 1)) -> Iterator[Job]:
        """The wanted jobs of shard i of n (i from 1), index by index, so that a part is a fair sample.

        Trials that are paired stay in one shard.
        """
        place = 0
        for index in range(max(map(len, self.starts.values()))):
            for group, starts in self.starts.items():
                if index >= len(starts):
                    continue
                place += 1
                if (place - shard[0]) % shard[1] == 0:
                    yield from (self.job(key) for key in self._keys(group, index) if wanted(key))

    def job(self, key: Key) -> Job:
        """The job of a key; raises ``NotFoundError`` for one that the grid does not have."""
        starts = self.starts.get((key.robot, key.task, key.object))
        scenario = self.scenarios.get((key.robot, key.task, key.method))
        if starts is None or scenario is None or key.index >= len(starts):
            most = max(map(len, self.starts.values()))
            s = self.settings
            raise NotFoundError(
                f"The grid has no trial {key}. Robots: {', '.join(s.robots)}. Tasks: {', '.join(s.tasks)}. "
                f"Objects: {', '.join(s.objects)}. Methods: {', '.join(s.methods)}. Indices: 0 to {most - 1}."
            )
        seed, start = starts[key.index]
        return Job(key, scenario.model_copy(update={"object": key.object, "seed": seed, "start": start}), seed)

    def _keys(self, group: Group, index: int) -> list[Key]:
        return [Key(*group, method, index) for method in self.settings.methods]


def make_plan(settings: GridSettings, starts: Mapping[Group, tuple[Beginning, ...]] | None = None) -> Plan:
    """The plan of a grid; ``starts`` come from a trial set.

    Raises ``InvalidInputError`` for settings that no trial can have, ``NotFoundError`` for a robot and task without a
    scenario file.
    """
    _check_overrides(settings.set)
    starts = starts or _drawn(settings)
    scenarios: dict[tuple[str, str, str], Scenario] = {}
    of_methods = [override for override in settings.set if _path(override).startswith("method.")]
    others = [override for override in settings.set if override not in of_methods]
    for robot, task in dict.fromkeys((robot, task) for robot, task, _ in starts):
        base = with_overrides(
            scenario_of(robot, task), [*others, f"profile={settings.profile}", f"timing.think={settings.think}"]
        )
        for method in settings.methods:
            furnished = base.model_copy(update={"method": METHODS[method]})
            scenarios[robot, task, method] = with_overrides(furnished, of_methods)
    _check_methods_differ(scenarios, settings.methods)
    return Plan(settings, scenarios, starts)


def up_to_date(decided: Mapping[str, Any]) -> dict[str, Any]:
    """What a plan decided at some time, with the settings that scenarios have got since: their defaults change nothing.

    Conditions that are none of a scenario any more are left as they are.
    """

    def now(cell: Any) -> Any:
        try:
            scenario = Scenario.model_validate_json(json.dumps({**cell, "title": "any", "object": ANY_OBJECT}))
        except ValidationError:
            return cell
        return scenario.model_dump(mode="json", exclude=OF_NO_EFFECT)

    return {**decided, "conditions": {name: now(cell) for name, cell in decided["conditions"].items()}}


def scenario_of(robot: str, task: str) -> Scenario:
    """The project's scenario of a robot and a task; raises ``NotFoundError``."""
    return load_scenario(scenario_name_of(robot, task))


def scenario_name_of(robot: str, task: str) -> str:
    """Name of the file with that scenario: of several, the shortest. Raises ``NotFoundError``."""
    names = (name for name, cell in _cells_of_files().items() if cell == (robot, task))
    name = min(names, key=lambda name: (len(name), name), default=None)
    if name is not None:
        return name
    raise NotFoundError(f"No file in scenarios/ has the robot {robot!r} with the task {task!r}.")


@cache
def _cells_of_files() -> dict[str, tuple[str, str]]:
    """Robot and task of every scenario file."""
    scenarios = {name: load_scenario(name) for name in scenario_names()}
    return {name: (scenario.robot, scenario.task.kind) for name, scenario in scenarios.items()}


def _drawn(settings: GridSettings) -> dict[Group, tuple[Beginning, ...]]:
    starts: tuple[Beginning, ...] = tuple((settings.first_seed + i, None) for i in range(settings.trials))
    return {group: starts for group in product(settings.robots, settings.tasks, settings.objects)}


def _check_overrides(overrides: tuple[str, ...]) -> None:
    for override in overrides:
        path = _path(override)
        if path in DECIDED_BY_THE_GRID or path.split(".")[0] in ("events", "start"):
            raise InvalidInputError(
                f"set: {override!r} is not a condition; a grid's robots, tasks, objects, methods, profile, think and "
                "first_seed have words of their own."
            )


def _check_methods_differ(scenarios: Mapping[tuple[str, str, str], Scenario], methods: tuple[str, ...]) -> None:
    """A setting of all methods may be the very one that two of them differ in."""
    robot, task, _ = next(iter(scenarios))
    seen = dict[Method, str]()
    for name in methods:
        rooms = scenarios[robot, task, name].method.model_copy(update={"name": "", "title": ""})
        if rooms in seen:
            raise InvalidInputError(f"set: it leaves no difference between the methods {seen[rooms]} and {name}.")
        seen[rooms] = name


def _path(override: str) -> str:
    return override.partition("=")[0].strip()
