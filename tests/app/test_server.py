"""Laws of run_server.py: what is wrong is said before anything starts, and Ctrl-C ends it cleanly."""

import os
import re
import signal
import socket
import subprocess
import sys
import time

import pytest

from tests.app.served import ROOT, serve

pytestmark = pytest.mark.timeout(60)


def run(*flags: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "run_server.py", *flags]
    return subprocess.run(command, capture_output=True, text=True, timeout=50, cwd=ROOT, check=False)


def test_a_port_in_use_is_said_and_not_changed() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        ended = run("--port", str(port))
    assert ended.returncode == 2
    assert f"Cannot listen on 127.0.0.1 port {port}: Address already in use." in ended.stderr
    assert "--port" in ended.stderr and "Traceback" not in ended.stderr


def test_an_unknown_scenario_lists_what_exists_before_anything_starts() -> None:
    ended = run("--port", "0", "--scenario", "turntabel")
    assert ended.returncode == 2
    assert "There is no scenario named 'turntabel'. Available:" in ended.stderr
    assert "ur5_linear" in ended.stderr and ended.stdout == ""


def test_other_machines_need_a_token() -> None:
    ended = run("--host", "0.0.0.0", "--port", "0")
    assert ended.returncode == 2 and "add --token SECRET" in ended.stderr


def test_help_names_every_setting_at_once() -> None:
    start = time.monotonic()
    ended = run("--help")
    assert time.monotonic() - start < 5.0
    for flag in ("--host", "--port", "--token", "--scenario", "--seed", "--paused", "--low-fx"):
        assert flag in ended.stdout
    assert ended.returncode == 0


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_cleanly_and_takes_the_simulation_along(end: signal.Signals) -> None:
    with serve("--paused", module=("run_server.py",)) as server:
        simulation = server.simulation_pid()
        server.process.send_signal(end)
        try:
            output, _ = server.process.communicate(timeout=40.0)
        except subprocess.TimeoutExpired:
            server.process.send_signal(signal.SIGABRT)  # it prints where each of its threads stands
            raise
        assert server.process.returncode == 0
        assert re.search(r"^Stopped\.$", output, re.MULTILINE)
    with pytest.raises(ProcessLookupError):
        os.kill(simulation, 0)
