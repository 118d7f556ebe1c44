"""Dashboard: draws the session into viser, one atomic frame after the other; nothing while nobody looks."""

from __future__ import annotations

import contextlib
import io
import secrets
import threading
import time

import viser

from app.reports import Started
from app.session import Session
from app.state import SessionState
from app.ui.camera import CameraKeeper
from app.ui.desk import Desk
from app.ui.help import Guide
from app.ui.memory import Memory
from app.ui.own import add_view_switches
from app.ui.panels import View
from app.ui.progress import AutoNext, Tally
from app.ui.robot_parts import load_robot_parts
from app.ui.rooms import furnish, light
from app.ui.start import start_viser
from app.ui.theme import Theme
from app.ui.touch import DeskTouch
from app.ui.worlds import Worlds
from app.view import SharedView
from backend.errors import GraspingError

FRAME_S = 1 / 30
PANELS_S = 1 / 5


class Dashboard:
    """Owns the viser server and the thread that draws."""

    def __init__(self, session: Session, low_fx: bool, tour: bool) -> None:
        self._session = session
        self.key = secrets.token_urlsafe(24)
        """Opens the viser server."""
        self.server = start_viser(self.key)
        self._camera = CameraKeeper(self.server, session)
        memory = Memory()
        self._theme, self._guide = Theme(memory), Guide(memory, tour)
        self._desk = Desk(self.server, session)
        self._auto_next = AutoNext()
        self._tally = Tally()
        self._worlds = Worlds(self.server.scene, DeskTouch(self._desk))
        self._stopping = threading.Event()
        self._begun: Started | None = None
        self._panels_due_s = 0.0
        self._refusals = 0
        self._view = session.state.view
        light(self.server.scene, low_fx)
        gui = self.server.gui
        self._panels = furnish(gui, lambda kind: kind(gui, self._desk), self._add_view_tab)
        self._draw_panels(session.state, 0.0)
        self.server.on_client_connect(self._seat)
        self.server.on_client_connect(self._welcome)
        self.server.on_client_disconnect(self._unseat)
        self._thread = threading.Thread(target=self._run, name="dashboard", daemon=True)

    def start(self) -> None:
        """Begin to draw."""
        self._thread.start()

    def close(self) -> None:
        """Stop drawing, then the viser server."""
        self._stopping.set()
        if self._thread.is_alive():
            self._thread.join(5.0)
        with contextlib.redirect_stdout(io.StringIO()):
            self.server.stop()

    def _add_view_tab(self) -> None:
        add_view_switches(self.server.gui, self._camera, self._theme, self._guide)

    async def _seat(self, client: viser.ClientHandle) -> None:
        self._desk.who.arrive(client)

    async def _unseat(self, client: viser.ClientHandle) -> None:
        self._desk.who.leave(client)

    def _welcome(self, client: viser.ClientHandle) -> None:
        """In a thread of viser's: the browser is asked what it remembers."""
        self._theme.welcome(client)
        self._guide.welcome(client)

    def _run(self) -> None:
        state: SessionState | None = None
        while not self._stopping.is_set():
            state = self._session.next_tick(state, FRAME_S)
            if self._desk.fulfil():
                state = self._session.state
                self._panels_due_s = 0.0  # whoever asked for something sees it at once
            self.draw(state)

    def draw(self, state: SessionState) -> None:
        """One frame."""
        now_s = time.monotonic()
        if state.started is not None and state.started is not self._begun:
            self._begin(state.started, state.view)
        if not self.server.get_clients():
            return
        if state.view is not self._view:
            self._view, self._panels_due_s = state.view, 0.0  # and so does everybody
        with self.server.atomic():
            if state.started is not None:
                self._worlds.draw(state.shown)
            if now_s >= self._panels_due_s:
                self._panels_due_s = now_s + PANELS_S
                self._draw_panels(state, now_s)

    def _begin(self, started: Started, view: SharedView) -> None:
        """A new trial is built even while nobody looks, so that whoever comes sees it at once."""
        load_robot_parts(started.scene.robot)  # slow at first; nothing is sent during an atomic block
        with self.server.atomic():
            self._worlds.begin(started, view)
            self._camera.begin(started)
        self._begun = started

    def _draw_panels(self, state: SessionState, now_s: float) -> None:
        self._tally = self._tally.after(state)
        remaining_s = self._auto_next.remaining_s(state, now_s)
        if remaining_s is not None and remaining_s <= 0.0:
            self._next_trial(state)
        if state.refusals[0] > self._refusals:
            self._refusals = state.refusals[0]
            self._desk.say("Not possible", state.refusals[1], "red")
        view = View(
            state.shown, state, self._session.history.moments(), self._tally, remaining_s, self._desk.status_line
        )
        for panel in self._panels:
            panel.show(view)
        self._desk.who.show()

    def _next_trial(self, state: SessionState) -> None:
        try:
            self._desk.restart(seed=state.restart.seed + 1)
        except GraspingError as error:
            self._desk.change_view(auto_next=False)
            self._desk.say("Not possible", f"{error}\nAuto next is off now.", "red")
