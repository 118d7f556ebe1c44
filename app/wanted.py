"""Wanted: the scenario that a ``Restart`` means, checked by the scenario's own model."""

from __future__ import annotations

import tomllib

from app.commands import OverrideValue, Restart
from backend.errors import InvalidInputError, lookup
from backend.methods import METHODS
from backend.scenario import Scenario, load_scenario, parse_scenario, scenario_names, with_overrides


def scenario_of(restart: Restart) -> Scenario:
    """Its file or the project's of that name, with its edits.

    Raises ``NotFoundError`` naming what exists, or ``InvalidInputError`` naming key and bound.
    """
    scenario = _base(restart)
    if restart.overrides:
        scenario = _edited(scenario, [f"{path}={_written(value)}" for path, value in restart.overrides.items()])
    if restart.events:
        scenario = scenario.model_copy(update={"events": (*scenario.events, *restart.events)})
    return scenario


def compared_with(restart: Restart) -> Restart | None:
    """The same trial under the method it is compared with, as that is listed; None where nothing is compared.

    Raises ``NotFoundError`` naming the methods there are.
    """
    if restart.compare is None:
        return None
    lookup("method", restart.compare, METHODS)
    kept = {path: value for path, value in restart.overrides.items() if path.partition(".")[0] != "method"}
    return restart.model_copy(update={"overrides": {**kept, "method": restart.compare}, "compare": None})


def read_scenario(text: str, name: str) -> Scenario:
    """The scenario in the text of a file called ``name``; raises ``InvalidInputError`` with every mistake."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InvalidInputError(f"{name}: not valid TOML: {error}") from None
    return parse_scenario(table, name)


def _base(restart: Restart) -> Scenario:
    if restart.file is not None:
        return read_scenario(restart.file, restart.scenario)
    names = scenario_names()  # a name from outside is never taken for a path
    return load_scenario(lookup("scenario", restart.scenario, dict(zip(names, names, strict=True))))


def _edited(scenario: Scenario, overrides: list[str]) -> Scenario:
    try:
        return with_overrides(scenario, overrides)
    except InvalidInputError as error:
        prefix = " ".join(overrides) + ": "  # says which edits were made, which the page shows anyway
        raise InvalidInputError(str(error).replace(prefix, "")) from None


def _written(value: OverrideValue) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
