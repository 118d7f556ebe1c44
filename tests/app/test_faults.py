"""Laws of faults: what goes wrong stays where it went wrong, and is said."""

from __future__ import annotations

import asyncio
import errno
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, cast

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from app.commands import Restart, SetPaused, SetSpeed
from app.engine import Keepsake, Running
from app.proxy import DeafError, outbound
from app.session import Session
from tests.app.fake_episode import LINEAR, FakeEngine, FakeEpisode
from tests.app.served import ROOT, Served, serve, wait_for
from tests.app.sessions import wait
from tests.app.viewer_client import PROTOCOL, ViewerClient, view

pytestmark = [pytest.mark.timeout(120), pytest.mark.xdist_group("served")]
WINDOW_S = 3.0


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour") as server:
        yield server


def play(served: Served) -> None:
    """A long trial, from its start, in real time."""
    served.command(kind="set_paused", paused=True)
    served.command(kind="restart", scenario="ur5_linear", seed=0)
    wait_for(served, tick=0, loading=False)
    served.command(kind="set_paused", paused=False)


def resident_MB(pid: int) -> float:
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def poses_in(viewer: ViewerClient, window_s: float) -> int:
    """How many new places of the object a viewer learns of in that time."""
    seen, deadline = len(viewer.messages), time.monotonic() + window_s
    while time.monotonic() < deadline:
        viewer.receive(0.2)
    new = viewer.messages[seen:]
    return sum(message["type"] == "SetPositionMessage" and message["name"] == "/object/body" for message in new)


def test_a_viewer_that_reads_nothing_slows_no_other_and_is_not_saved_up_for(served: Served) -> None:
    play(served)
    with view(served.authority) as good:
        good.wait_for("MeshMessage", name="/object/body")
        alone = poses_in(good, WINDOW_S)
        assert alone > 10
        before_MB = resident_MB(served.process.pid)
        with ExitStack() as stack:
            for _ in range(3):
                stack.enter_context(silent(served))
            together = poses_in(good, WINDOW_S)
            later = poses_in(good, WINDOW_S)
            grown_MB = resident_MB(served.process.pid) - before_MB
    assert min(together, later) > 0.5 * alone
    assert grown_MB < 60.0


def silent(served: Served) -> Any:
    """A viewer that asks for everything, and takes as little as its system lets it."""
    host, port = served.authority.split(":")
    narrow = socket.socket()
    narrow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    narrow.connect((host, int(port)))
    return connect(
        f"ws://{served.authority}/viewer",
        sock=narrow,
        subprotocols=[PROTOCOL],
        max_queue=1,
        compression=None,
        proxy=None,
    )


def test_a_browser_that_takes_nothing_is_given_up() -> None:
    class Deaf:
        async def send_bytes(self, _: bytes) -> None:
            await asyncio.Event().wait()

    async def news() -> AsyncIterator[bytes]:
        yield b"news"

    begin_s = time.monotonic()
    with pytest.raises(DeafError):
        asyncio.run(outbound(news(), cast(Any, Deaf()), patience_s=0.1))
    assert time.monotonic() - begin_s < 5.0


def test_eight_viewers_are_served_alike_and_a_ninth_is_told_why_not(served: Served) -> None:
    play(served)
    counts = [0] * 8
    with ExitStack() as stack:
        viewers = [stack.enter_context(view(served.authority)) for _ in range(8)]
        for viewer in viewers:
            viewer.wait_for("MeshMessage", name="/object/body")

        def count(i: int) -> None:
            counts[i] = poses_in(viewers[i], WINDOW_S)

        threads = [threading.Thread(target=count, args=(i,)) for i in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        health = httpx.get(served.address + "api/v1/health").json()
        assert (health["viewers"], health["most_viewers"]) == (8, 8)
        with pytest.raises(ConnectionClosed, match="At most 8 browsers"), view(served.authority) as ninth:
            while True:
                ninth.receive()
    assert min(counts) > 5 and min(counts) > 0.5 * max(counts), counts


class FullDisk(FakeEpisode):
    """Leaves nothing, since there is no room to put it."""

    def keepsake(self) -> Keepsake:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


class FullDiskEngine(FakeEngine):
    """Seed 1 finds the disk full at the trial's end, seed 3 at its start."""

    def make_episode(self, restart: Restart) -> Running:
        if restart.seed == 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        kind = FullDisk if restart.seed == 1 else FakeEpisode
        return kind(self.describe(restart), restart.seed)


def test_a_full_disk_is_said_and_the_simulation_goes_on() -> None:
    session = Session(FullDiskEngine(), LINEAR.model_copy(update={"seed": 1}), paused=False)
    session.start()
    try:
        session.send(SetSpeed(speed=None))
        state = wait(session, lambda s: s.refusals[0] == 1)
        assert "could not be kept" in state.refusals[1] and "No space left on device" in state.refusals[1]
        assert state.status == "running" and state.keepsake is None
        assert state.snapshot is not None and state.snapshot.outcome is not None
        session.send(LINEAR.model_copy(update={"seed": 3}))
        state = wait(session, lambda s: s.refusals[0] == 2)
        assert "cannot begin" in state.refusals[1] and "No space left" in state.refusals[1]
        session.send(LINEAR.model_copy(update={"seed": 2}))
        state = wait(session, lambda s: s.keepsake is not None)
        assert state.status == "running" and state.refusals[0] == 2
        session.send(SetPaused(paused=True))
    finally:
        session.close()


INTERRUPTED = """
import os, signal, sys, threading, time
import uvicorn
factory = uvicorn.Config.get_loop_factory

def interrupted(config):
    def make():
        os.kill(os.getpid(), signal.{name})
        time.sleep(0.05)
        return factory(config)()
    return make

uvicorn.Config.get_loop_factory = interrupted
signal.signal(signal.SIGTERM, signal.default_int_handler)
sys.argv = ["served", "--port", "0", "--paused"]
from tests.app.served import main
main()
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_an_interrupt_amid_the_start_ends_it_without_a_word_of_warning(name: str) -> None:
    code = INTERRUPTED.replace("{name}", name)
    ended = subprocess.run(
        [sys.executable, "-W", "always", "-c", code], capture_output=True, text=True, timeout=60, cwd=ROOT, check=False
    )
    assert ended.stderr == ""
    assert ended.returncode == 0 and ended.stdout.endswith("Stopped.\n")
