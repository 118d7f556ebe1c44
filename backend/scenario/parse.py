"""From plain tables to a Scenario, and from pydantic's complaints to sentences that help."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from backend.config import complaint
from backend.errors import InvalidInputError
from backend.scenario.model import Scenario
from backend.scenario.settings import model_at

SPEAKS_FOR_ITSELF = ("unknown_name", "method_name", "start")
"""Errors whose text needs no repetition of the value."""


def parse_scenario(table: Mapping[str, Any], where: str = "") -> Scenario:
    """The scenario of a table as TOML or JSON gives it.

    Raises ``InvalidInputError`` with one line per mistake: ``where: path.to.key: what is wrong``.
    """
    try:
        return Scenario.model_validate(dict(table))
    except ValidationError as error:
        prefix = f"{where}: " if where else ""
        lines = (prefix + _sentence(entry) for entry in error.errors(include_url=False))
        raise InvalidInputError("\n".join(lines)) from None


def _sentence(entry: Any) -> str:
    if entry["type"] in SPEAKS_FOR_ITSELF:
        return ".".join(str(part) for part in entry["loc"]) + ": " + str(entry["msg"])
    text = complaint(entry)
    return text + _nearest(entry["loc"]) if entry["type"] == "extra_forbidden" else text


def _nearest(location: tuple[str | int, ...]) -> str:
    """What was probably meant by a key that nothing knows, or all that exists there."""
    model = model_at(Scenario, location[:-1])
    names = [] if model is None else sorted(model.model_fields)
    near = difflib.get_close_matches(str(location[-1]), names, n=1)
    if near:
        return f". Did you mean {near[0]!r}?"
    return f". Available: {', '.join(names)}." if names else ""
