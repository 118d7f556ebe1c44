"""The dashboard over the fake engine, in a process of its own: ``python -m tests.app.served --port 0``."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Served:
    """A running server."""

    address: str
    process: subprocess.Popen[str]

    @property
    def authority(self) -> str:
        """Host and port."""
        return self.address.split("/")[2]

    def state(self) -> dict[str, object]:
        """Answer of /api/v1/session."""
        return httpx.get(self.address + "api/v1/session", timeout=5.0).json()

    def command(self, **fields: object) -> httpx.Response:
        """Post a command, taking control for it and giving it back."""
        with httpx.Client(base_url=self.address + "api/v1/session/", timeout=5.0) as script:
            script.post("driver")
            answer = script.post("commands", json=fields)
            script.delete("driver")
            return answer

    def simulation_pid(self) -> int:
        """Process id of the spawned simulation."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        spawned = [pid for pid in children if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()]
        assert len(spawned) == 1, spawned
        return int(spawned[0])


@contextmanager
def serve(*flags: str, module: tuple[str, ...] = ("-m", "tests.app.served")) -> Generator[Served]:
    """Start a server on a free port, with no runs of grids, wait for its address, end it with Ctrl-C.

    One that does not end is made to print where each of its threads stands.
    """
    command = [sys.executable, *module, "--port", "0", *flags]
    runs = tempfile.TemporaryDirectory()
    own = {**os.environ, "GRASPING_RUNS": runs.name, "PYTHONFAULTHANDLER": "1"}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT, env=own)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        address = re.search(r"http://[^/]+/", line)
        assert address, f"no address but {line!r}"
        yield Served(address[0], process)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        try:
            process.communicate(timeout=15.0)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGABRT)
            raise
        finally:
            runs.cleanup()


def wait_for(
    served: Served, ready: Callable[[dict[str, object]], bool] | None = None, patience_s: float = 15.0, **fields: object
) -> dict[str, object]:
    """The state, once ``ready`` says yes to it and it has these ``fields``."""
    deadline = time.monotonic() + patience_s
    while True:
        state = served.state()
        if (ready is None or ready(state)) and all(state[name] == value for name, value in fields.items()):
            return state
        assert time.monotonic() < deadline, f"{fields or 'it'} not reached: {state}"
        time.sleep(0.03)


def begin_anew(served: Served) -> None:
    """The same trial for every test, at its start and paused."""
    assert served.command(kind="set_paused", paused=True).status_code == 202
    assert served.command(kind="restart", scenario="ur5_linear", seed=0).status_code == 202
    wait_for(served, lambda s: s["tick"] == 0 and s["loading"] is False and s["paused"] is True)


def play_to(served: Served, tick: int) -> None:
    """Play at four times the pace, which stays, and pause at that tick or soon after it."""
    served.command(kind="set_speed", speed=4.0)
    served.command(kind="set_paused", paused=False)
    wait_for(served, lambda s: int(str(s["tick"])) >= tick)
    served.command(kind="set_paused", paused=True)
    wait_for(served, lambda s: s["paused"] is True)


def main() -> None:
    """Serve until interrupted."""
    from app.serve import serve as serve_dashboard
    from app.settings import read_settings
    from run_server import listen
    from tests.app.fake_episode import FakeEngine

    settings = read_settings(sys.argv[1:], os.environ)
    try:
        serve_dashboard(settings, listen(settings), FakeEngine())
    except KeyboardInterrupt:
        print("Stopped.")


if __name__ == "__main__":
    main()
