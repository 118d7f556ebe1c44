"""Desk: where everything that browsers ask for arrives, is checked, and is answered."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import viser
from pydantic import ValidationError

from app.commands import Command, OverrideValue, Restart
from app.people import NotDrivingError
from app.session import Session
from app.ui.who import Who
from app.view import SharedView
from backend.config import Config, explain
from backend.errors import GraspingError, InvalidInputError

Answer = str | None
Color = Literal["blue", "red", "green"]
NOTICE_S = 6.0
REFUSAL_S = 0.3
"""After so long a browser that only watches is told so, once for all that it did meanwhile."""
QUIET_S = 1.5
"""How long a widget is left alone after somebody has touched it."""


@dataclass(frozen=True)
class Wish:
    """Something a person did in a browser."""

    act: Callable[[], Answer]
    client: viser.ClientHandle | None
    due_s: float


class Desk:
    """Callbacks of viser come from other threads: they only leave wishes here."""

    def __init__(self, server: viser.ViserServer, session: Session) -> None:
        self.session = session
        self.status_line = ""
        """The last answer, for the status line."""
        self.who = Who(session.people)
        self._server = server
        self._lock = threading.Lock()
        self._wishes: dict[str, Wish] = {}
        self._touched_s: dict[str, float] = {}
        self._mirrored: dict[str, object] = {}

    def wish(
        self, key: str, act: Callable[[], Answer], client: viser.ClientHandle | None, after_s: float = 0.0
    ) -> None:
        """Ask for ``act`` to be done ``after_s`` from now; a newer wish of the same key takes its place.

        ``act`` returns what to say to everybody, or None; a ``GraspingError`` is said to the one who asked. Of a
        browser that only watches nothing is done: it is told so, and its widget shows the truth again.
        """
        if client is not None and not self.admits(client):
            with self._lock:
                self._mirrored.pop(key, None)
            return
        now = time.monotonic()
        with self._lock:
            self._wishes.pop(key, None)
            self._wishes[key] = Wish(act, client, now + after_s)
            self._touched_s[key] = now
            self._mirrored.pop(key, None)

    def admits(self, client: viser.ClientHandle) -> bool:
        """Whether this browser drives; one that does not is told who does, and how to take over."""
        objection = self.who.objection(client)
        if objection is None:
            return True

        def refuse() -> Answer:
            raise objection

        with self._lock:
            self._wishes[f"refusal {client.client_id}"] = Wish(refuse, client, time.monotonic() + REFUSAL_S)
        return False

    def mirror(self, key: str, widget: Any, truth: object) -> None:
        """Let a widget show what is true, once that has changed or somebody has been at it and is so no more.

        Not each time the two differ: what was chosen a moment ago is not true yet.
        """
        with self._lock:
            touched_s = self._touched_s.get(key, -QUIET_S)
            if time.monotonic() - touched_s < QUIET_S or self._mirrored.get(key) == truth:
                return
            self._mirrored[key] = truth
        widget.value = truth

    def fulfil(self) -> bool:
        """Do what is due, and say whether there was anything; called by the dashboard's thread only."""
        now = time.monotonic()
        with self._lock:
            due = [key for key, wish in self._wishes.items() if wish.due_s <= now]
            wishes = [(key, self._wishes.pop(key)) for key in due]
        for key, wish in wishes:
            self._fulfil(key, wish)
        return bool(wishes)

    def send(self, command: Command) -> None:
        """Pass a command on; raises ``GraspingError``."""
        self.session.send(command)

    def change_view(self, **values: Any) -> Answer:
        """Change what everybody is shown; raises ``InvalidInputError``."""
        change = checked(SharedView, **values)
        self.session.change_view(lambda view: view.changed(change))
        return None

    def restart(
        self,
        scenario: str | None = None,
        seed: int | None = None,
        overrides: dict[str, OverrideValue] | None = None,
    ) -> Restart:
        """Restart with what is given changed and the rest as it is; raises ``GraspingError``.

        Another scenario starts from its own file; otherwise ``overrides`` add to those there are. With nothing
        given the trial is the one that was asked for, edits that came with it included; any change drops those.
        """
        now = self.session.state.restart
        begun = self.session.state.info.values.start is not None
        if begun and any(path.startswith("task.") for path in overrides or ()):
            raise InvalidInputError(
                "This trial begins as its file says under [start], whatever its task would draw. "
                "Choose a scenario of the list to have it drawn."
            )
        if scenario is not None and scenario != now.scenario:
            return self.begin(scenario=scenario, seed=now.seed if seed is None else seed, compare=now.compare)
        same = seed is None and not overrides
        return self.begin(
            scenario=now.scenario,
            file=now.file,
            seed=now.seed if seed is None else seed,
            overrides=merged(now.overrides, overrides or {}),
            events=now.events if same else (),
            compare=now.compare,
        )

    def compare(self, method: str | None) -> Restart:
        """Restart the same trial beside one under another method, or alone; raises ``GraspingError``."""
        now = self.session.state.restart.model_copy(update={"from_tick": 0})
        return self.begin(**{**now.model_dump(exclude={"kind"}), "compare": method})

    def begin(self, **values: Any) -> Restart:
        """Begin a trial from nothing but what is given; raises ``GraspingError``."""
        command = checked(Restart, **values)
        self.send(command)
        return command

    def say(self, title: str, text: str, color: Color, client: viser.ClientHandle | None = None) -> None:
        """Notify one browser, or all."""
        for listener in [client] if client is not None else list(self._server.get_clients().values()):
            listener.add_notification(title, text, auto_close_seconds=NOTICE_S, color=color)

    def _fulfil(self, key: str, wish: Wish) -> None:
        try:
            answer = wish.act()
        except GraspingError as error:
            self.say("Not possible", str(error), "red", wish.client)
            if isinstance(error, NotDrivingError):
                return
            self.status_line = f"Refused: {error}"
            with self._lock:
                self._touched_s.pop(key, None)
            return
        if answer is not None:
            self.status_line = answer
            self.say("Done", answer, "blue")


def merged(kept: Mapping[str, OverrideValue], new: Mapping[str, OverrideValue]) -> dict[str, OverrideValue]:
    """Overrides in the order they act: a new kind or method takes the place of what was set below the old one."""
    out = dict(kept)
    for path, value in new.items():
        below = path.removesuffix("kind") if path.endswith(".kind") else path + "."
        out = {name: was for name, was in out.items() if name != path and not name.startswith(below)}
        out[path] = value
    return out


def checked(kind: type[Any], **values: Any) -> Any:
    """A command or event of ``kind`` from a browser's values; raises ``InvalidInputError`` with the bound."""
    assert issubclass(kind, Config)
    try:
        return kind.model_validate(values)
    except ValidationError as error:
        raise InvalidInputError(explain(error)) from None
