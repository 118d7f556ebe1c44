"""Share: a link to exactly this trial, scenario files in and out, and what a trial leaves behind."""

from __future__ import annotations

from pathlib import PurePath

import viser

from app.commands import LARGEST_FILE_CHARS
from app.permalink import address_of
from app.state import SessionState
from app.ui.desk import Answer, Desk
from app.ui.panels.panel import View
from app.ui.words import link_button, page_link, tip
from backend.errors import InvalidInputError

FILES = "/api/v1/session"


class SharePanel:
    """Links are plain addresses: what they lead to is checked like every command."""

    def __init__(self, gui: viser.GuiApi, desk: Desk) -> None:
        self._desk = desk
        with gui.add_folder("This trial"):
            self._link = gui.add_html("")
        with gui.add_folder("Scenario file"):
            self._upload = gui.add_upload_button(
                "Open a file", icon=viser.Icon.UPLOAD, hint="A scenario (.toml), as downloaded here", mime_type=".toml"
            )
            gui.add_html(link_button("Download scenario", f"{FILES}/scenario.toml"))
        with gui.add_folder("Trial files"):
            gui.add_html(link_button("Download replay (HTML)", f"{FILES}/replay.html"))
            self._outcome = gui.add_html("")
        with gui.add_folder("Many trials"):
            gui.add_html(page_link("Experiments", "/experiments"))
        self._linked: tuple[object, object] = (None, None)
        self._upload.on_upload(self._on_upload)

    def show(self, view: View) -> None:
        state = view.live
        if (state.restart, state.events) != self._linked:
            self._linked = state.restart, state.events
            self._link.content = link_button("Copy link", address_of(state.repeated), copy=True) + tip(what(state))
        if state.keepsake is None:
            self._outcome.content = tip("When the trial has ended, its trace and its outcome can be downloaded here.")
        else:
            trace, record = f"{FILES}/trace.npz", f"{FILES}/outcome.json"
            links = [("Download trace", trace), ("Download outcome", record)]
            if state.keepsake_beside is not None:
                links.append((f"Download trace of {state.restart.compare}", f"{trace}?compared=true"))
            self._outcome.content = "".join(link_button(text, address) for text, address in links)

    def open_file(self, name: str, content: bytes) -> Answer:
        """Restart with a scenario file that somebody brought; raises ``GraspingError`` naming every mistake."""
        if len(content) > LARGEST_FILE_CHARS:
            raise InvalidInputError(f"{name}: a scenario file has at most {LARGEST_FILE_CHARS} bytes.")
        try:
            text = content.decode()
        except UnicodeDecodeError as error:
            raise InvalidInputError(f"{name}: not UTF-8 text (byte {error.start}).") from None
        stem = PurePath(name).stem[:80] or "file"
        seed = self._desk.session.engine.seed_in(stem, text)
        self._desk.begin(scenario=stem, file=text, seed=seed, compare=self._desk.session.state.restart.compare)
        return f"Restarted with the scenario in {name}."

    async def _on_upload(self, event: viser.GuiEvent[viser.GuiUploadButtonHandle]) -> None:
        file = event.target.value
        self._desk.wish("upload", lambda: self.open_file(file.name, file.content), event.client)


def what(state: SessionState) -> str:
    """What the link leads to, in words."""
    settings, edits = len(state.restart.overrides), len(state.events)
    parts = [f"Opens {state.info.scenario}, seed {state.restart.seed}"]
    parts += [f"{settings} setting{'s' * (settings > 1)} changed"] if settings else []
    parts += ["begun as its file says"] if state.info.values.start else []
    parts += [f"beside {state.restart.compare}"] if state.restart.compare else []
    parts += [f"{edits} live edit{'s' * (edits > 1)}"] if edits else []
    return ", ".join(parts) + "."
