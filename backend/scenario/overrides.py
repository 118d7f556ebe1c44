"""Overrides: ``path=value`` changes any value of a scenario, as ``--set`` on the command line does."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from typing import Any

from backend.errors import InvalidInputError, lookup, not_found_text
from backend.methods import METHODS
from backend.scenario.model import Scenario, Table
from backend.scenario.parse import parse_scenario
from backend.scenario.settings import Model, models_in, of_kind


def with_overrides(scenario: Scenario, overrides: Iterable[str]) -> Scenario:
    """The scenario with every ``path=value`` set, then checked as a whole.

    Values are TOML; a bare word is a string; ``none`` takes a setting back to its default. Another ``kind``
    keeps the settings that the new kind has too. Raises ``InvalidInputError``; an unknown path is answered
    with what exists at that level.
    """
    listed = tuple(overrides)
    table = scenario.model_dump()
    for override in listed:
        _apply(table, override)
    return parse_scenario(table, " ".join(listed))


def _apply(table: Table, override: str) -> None:
    path, equals, text = override.partition("=")
    names = [name.strip() for name in path.split(".")]
    if not equals or not all(names):
        raise InvalidInputError(f"An override is path=value, such as task.speed_mps=0.08, not {override!r}.")
    here, options = table, list[Model]([Scenario])
    for depth in range(1, len(names)):
        here, options = _descend(here, options, names[:depth])
    _check_name(_current(here, options), names)
    _set(here, options, names[-1], _value(text.strip()))


def _descend(table: Table, options: list[Model], path: list[str]) -> tuple[Table, list[Model]]:
    """The table below the end of ``path``, and what models it may be."""
    name, model = path[-1], _current(table, options)
    _check_name(model, path)
    if path == ["method"] and isinstance(table[name], str):
        table[name] = lookup("method", table[name], METHODS).model_dump()
    below, below_options = table.get(name), models_in(model.model_fields[name].annotation)
    if not isinstance(below, dict) or not below_options:
        raise InvalidInputError(f"{'.'.join(path)} is a single value: it has no settings of its own.")
    return below, below_options


def _set(table: Table, options: list[Model], name: str, value: Any) -> None:
    if value is None:
        table.pop(name, None)
        return
    table[name] = value
    if name == "kind":
        model = of_kind(options, value)
        known = {"kind"} if model is None else set(model.model_fields)
        for foreign in set(table) - known:
            del table[foreign]


def _current(table: Table, options: list[Model]) -> Model:
    """The model of a table by its kind; of an unknown kind, which is complained about later, the first."""
    return of_kind(options, table.get("kind")) or options[0]


def _check_name(model: Model, path: list[str]) -> None:
    if path[-1] in model.model_fields:
        return
    level = ".".join(path[:-1])
    kind = f"setting of {level}" if level else "setting"
    raise InvalidInputError(not_found_text(kind, path[-1], model.model_fields))


def _value(text: str) -> Any:
    """A TOML value; None for ``none``; any other text that is not TOML as it stands."""
    if text == "none":
        return None
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
