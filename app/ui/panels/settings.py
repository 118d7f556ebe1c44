"""Settings: widgets for whatever a part of the scenario's model can be set to, made from the model itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import viser

from app.commands import OverrideValue
from app.ui.desk import Answer, Desk
from app.ui.fields import DRAWN, UNSET, Field, Value
from backend.errors import InvalidInputError

SETTLE_S = 0.8
"""Typed values act when the typing has stopped for so long."""
STEPS = 100
DIGITS = 4
"""Behind the point, of what can be typed."""


class SettingsGroup:
    """One folder of widgets; rebuilt when the model brings other fields, as another kind of planner does."""

    def __init__(self, gui: viser.GuiApi, desk: Desk, title: str | None, expanded: bool = True) -> None:
        self._gui = gui
        self._desk = desk
        self._folder = gui.add_folder(title, expand_by_default=expanded)
        self._fields: tuple[Field, ...] = ()
        self._widgets: list[Any] = []

    def show(self, fields: Iterable[Field]) -> None:
        """Show these fields with the values they have."""
        fields = tuple(fields)
        if fields != self._fields:
            self._rebuild(fields)
        self._folder.visible = bool(fields)
        for field, widget in zip(fields, self._widgets, strict=True):
            self._desk.mirror(field.path, widget, on_screen(field))
            if widget.hint != field.hint:
                widget.hint = field.hint

    def _rebuild(self, fields: tuple[Field, ...]) -> None:
        for widget in self._widgets:
            widget.remove()
        self._fields = fields
        with self._folder:
            self._widgets = [self._add(field) for field in fields]

    def _add(self, field: Field) -> Any:
        widget = add_widget(self._gui, field)
        settle_s = 0.0 if field.sort in ("choice", "switch") else SETTLE_S

        async def on_update(event: viser.GuiEvent[Any]) -> None:
            if event.client is not None:  # None: set by ``show``
                value = event.target.value
                self._desk.wish(field.path, lambda: self.set(field, value), event.client, settle_s)

        widget.on_update(on_update)
        return widget

    def set(self, field: Field, shown: object) -> Answer:
        """Restart with what somebody chose; raises ``GraspingError`` when the scenario's model refuses it."""
        value = from_screen(field, shown)
        self._desk.restart(overrides={field.path: value})
        text = DRAWN if value == UNSET else f"{shown}"
        return f"Restarted with {field.label}: {text}."


def add_widget(gui: viser.GuiApi, field: Field) -> Any:
    """The widget that suits a field; its bounds are the model's business, which names them when it refuses."""
    value: Any = on_screen(field)
    match field.sort:
        case "choice":
            return gui.add_dropdown(field.label, tuple(map(_word, field.choices)), initial_value=value, hint=field.hint)
        case "switch":
            return gui.add_checkbox(field.label, value, hint=field.hint)
        case "drawn":
            return gui.add_text(field.label, value, hint=field.hint)
        case "whole" | "number":
            number = gui.add_number(field.label, value, step=_step(field), hint=field.hint)
            number.precision = 0 if field.sort == "whole" else DIGITS
            return number


def on_screen(field: Field) -> bool | int | float | str:
    """The field's value as its widget shows it."""
    value = field.value
    if field.sort in ("choice", "drawn"):
        return _word(field.unit.shown(value) if isinstance(value, float) else value)
    assert value is not None
    return field.unit.shown(value) if field.sort == "number" and not isinstance(value, str) else value


def from_screen(field: Field, shown: object) -> OverrideValue:
    """What a widget shows, as an override has it; raises ``InvalidInputError`` for what is not of its sort."""
    read: dict[str, Callable[[Any], OverrideValue]] = {
        "choice": lambda text: _raw(field, text),
        "switch": bool,
        "whole": int,
        "number": lambda figure: field.unit.si(float(figure)),
        "drawn": lambda text: UNSET if text.strip() in ("", DRAWN) else field.unit.si(float(text)),
    }
    try:
        return read[field.sort](shown)
    except (TypeError, ValueError, AttributeError, OverflowError):
        raise InvalidInputError(f"{field.path}: not a {field.label.partition(',')[0].lower()}: {shown!r}") from None


def _word(value: Value) -> str:
    return DRAWN if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _raw(field: Field, word: str) -> OverrideValue:
    for choice in field.choices:
        if _word(choice) == word:
            return UNSET if choice is None else choice
    raise InvalidInputError(f"{field.path}: choose one of {', '.join(map(_word, field.choices))} (got {word!r})")


def _step(field: Field) -> float | int:
    """Of the little arrows: about a hundredth of the range, or a tenth of what is set."""
    if field.sort == "whole":
        return 1
    assert not isinstance(field.value, str) and field.value is not None
    span = field.unit.per_si * (field.high - (field.low or 0.0)) / STEPS if field.high is not None else 0.1
    return float(f"{max(min(span, 1.0), 0.001):.1g}")
