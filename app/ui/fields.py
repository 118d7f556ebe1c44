"""Fields: what can be set in a scenario, read off the scenario's own model, so that what is new there shows here."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal

from app.ui.units import PURE, Unit, split_unit
from backend.scenario import Scenario

Node = dict[str, Any]
Value = bool | int | float | str | None
Sort = Literal["choice", "switch", "whole", "number", "drawn"]
DRAWN = "drawn"
"""What stands for a value that is left to the seed."""
UNSET = "none"
"""How an override says the same."""


@dataclass(frozen=True)
class Field:
    """One setting."""

    path: str
    """As overrides name it: ``method.predictor.kind``."""
    sort: Sort
    """``drawn`` is a number that may be left to the seed."""
    label: str
    hint: str = field(compare=False)
    """What it is, in which unit, within which bounds."""
    unit: Unit = PURE
    low: float | None = None
    high: float | None = None
    choices: tuple[Value, ...] = ()
    value: Value = field(default=None, compare=False)

    @property
    def group(self) -> str:
        """Path of the table it stands in."""
        return self.path.rpartition(".")[0]


def fields_in(scenario: Scenario, path: str) -> tuple[Field, ...]:
    """Every setting at or below ``path``, in the model's order; kinds come before what they bring with them."""
    node, value = _schema(), scenario.model_dump()
    for name in path.split("."):
        node, value = _chosen(node, value)["properties"][name], value[name]
    return tuple(_walk(path, node, value))


class FieldsOf:
    """What ``fields_in`` says of one path, worked out again only for another scenario."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._scenario: Scenario | None = None
        self._fields: tuple[Field, ...] = ()

    def of(self, scenario: Scenario) -> tuple[Field, ...]:
        """The settings with the values they have in ``scenario``."""
        if scenario is not self._scenario:
            self._scenario, self._fields = scenario, fields_in(scenario, self._path)
        return self._fields


@cache
def _schema() -> Node:
    return Scenario.model_json_schema()


def _walk(path: str, node: Node, value: Any) -> Iterator[Field]:
    if not isinstance(value, dict):
        found = _single(path, node, value)
        if found is not None:
            yield found
        return
    kinds = tuple(node.get("discriminator", {}).get("mapping", {}))
    if len(kinds) > 1:
        label = _label(path.rpartition(".")[2])
        hint = " ".join(_chosen(node, value).get("description", "").split())
        yield Field(f"{path}.kind", "choice", label, hint, choices=kinds, value=value["kind"])
    for name, child in _chosen(node, value)["properties"].items():
        if name not in ("kind", "name", "title"):
            yield from _walk(f"{path}.{name}", child, value[name])


def _chosen(node: Node, value: Any) -> Node:
    """The table's own schema: references followed, the kind that is in force taken."""
    if "discriminator" in node:
        return _referred(node["discriminator"]["mapping"][value["kind"]])
    return _referred(node["$ref"]) if "$ref" in node else node


def _referred(reference: str) -> Node:
    return _schema()["$defs"][reference.rpartition("/")[2]]


def _single(path: str, node: Node, value: Value) -> Field | None:
    """The field of a single value; None for what has no widget, such as free text."""
    options = [option for option in node.get("anyOf", [node]) if option.get("type") != "null"]
    core = options[0]
    optional = len(options) < len(node.get("anyOf", [node]))
    stem, unit = split_unit(path.rpartition(".")[2])
    low = core.get("minimum", core.get("exclusiveMinimum"))
    high = core.get("maximum", core.get("exclusiveMaximum"))
    hint = _hint(" ".join(node.get("description", "").split()), core, unit, optional)
    sort: Sort
    choices: tuple[Value, ...] = ()
    if "enum" in core:
        sort, choices = "choice", (*([None] if optional else []), *core["enum"])
    elif core.get("type") == "boolean":
        sort = "switch"
    elif core.get("type") in ("number", "integer"):
        sort = "drawn" if optional else "whole" if core["type"] == "integer" else "number"
    else:
        return None
    return Field(path, sort, _label(stem, unit), hint, unit, low, high, choices, value)


def _label(stem: str, unit: Unit = PURE) -> str:
    words = stem.replace("_", " ")
    words = words[:1].upper() + words[1:]
    return f"{words}, {unit.symbol}" if unit.symbol else words


def _hint(text: str, core: Node, unit: Unit, optional: bool) -> str:
    bounds: list[str] = []
    for key, word in (
        ("minimum", "from"),
        ("exclusiveMinimum", "above"),
        ("maximum", "to"),
        ("exclusiveMaximum", "below"),
    ):
        if key in core:
            bounds.append(f"{word} {unit.shown(core[key]):g}")
    limits = " ".join([*bounds, unit.symbol]).strip() if bounds else unit.symbol
    extra = "empty: drawn from the seed" if optional and "enum" not in core else ""
    tail = "; ".join(part for part in (limits, extra) if part)
    return f"{text} ({tail})" if text and tail else text or tail
