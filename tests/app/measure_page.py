"""Measure the page: ``python -m tests.app.measure_page [--minutes 10] [--json]``.

Starts the real server, opens it in headless Chromium, plays, and prints time to the first frame, poses and
traffic a second, the server's share of a core and the growth of its memory and of the simulation's.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path

from playwright.sync_api import Page, WebSocket

from tests.app.browser import open_browser, open_page, wait_for_node
from tests.app.served import Served, serve

FIRST_FRAME_S = 4.0
POSES_HZ = 30.0
TRAFFIC_KBPS = 120.0
SERVER_SHARE = 0.25
SERVER_SHARE_OF_SEVERAL = 0.30
"""With more than one page open."""
CLOCK_TICKS_PER_S = os.sysconf("SC_CLK_TCK")
WINDOW_S = 1.0
WARM_UP_SHARE = 0.2
"""Of the run, before growth of memory is looked at: caches fill first."""


@dataclass(frozen=True)
class Measurement:
    """One run."""

    first_frame_s: float
    poses_hz: float
    """Batches of scene poses a second that reached the browser while the trial moved."""
    real_time_factor: float
    traffic_kBps: float
    """To the first viewer."""
    server_share: float
    """Of one core, without the simulation process."""
    simulation_share: float
    server_growth_MB_per_min: float
    simulation_growth_MB_per_min: float
    server_MB: float
    minutes: float
    load: float
    """Of the machine, processes waiting to run, over the last minute."""


def cpu_s(pid: int) -> float:
    """User and system time so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / CLOCK_TICKS_PER_S


def resident_MB(pid: int) -> float:
    """Resident memory."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def growth_per_min(samples: list[tuple[float, float]]) -> float:
    """Slope of (s, MB) by least squares, in MB a minute."""
    t = [s / 60.0 for s, _ in samples]
    mean_t, mean_y = sum(t) / len(t), sum(y for _, y in samples) / len(samples)
    spread = sum((x - mean_t) ** 2 for x in t)
    return sum((x - mean_t) * (y - mean_y) for x, (_, y) in zip(t, samples, strict=True)) / max(spread, 1e-9)


class Wire:
    """Counts what the page's websocket receives."""

    def __init__(self, page: Page) -> None:
        self.batches = 0
        self.received_bytes = 0
        page.on("websocket", self._listen)

    def _listen(self, socket: WebSocket) -> None:
        socket.on("framereceived", self._count)

    def _count(self, payload: bytes | str) -> None:
        self.batches += 1
        self.received_bytes += len(payload)


def measure(served: Served, minutes: float, viewers: int) -> Measurement:
    """Look at the page for so long; all but the first of the viewers do not draw what they are sent."""
    pids = served.process.pid, served.simulation_pid()
    with ExitStack() as stack:
        browser = stack.enter_context(open_browser())
        page = stack.enter_context(open_page(browser, "about:blank", drawn=True))
        wire = Wire(page)
        start_s = time.monotonic()
        page.goto(served.address)
        wait_for_node(page, "/object/body", 60.0)
        wait_for_node(page, "/robot", 60.0)
        first_frame_s = time.monotonic() - start_s
        for _ in range(viewers - 1):
            wait_for_node(stack.enter_context(open_page(browser, served.address)), "/object/body", 60.0)
        page.wait_for_timeout(3000)
        return _watch(served, page, wire, pids, first_frame_s, minutes)


def _watch(
    served: Served, page: Page, wire: Wire, pids: tuple[int, int], first_frame_s: float, minutes: float
) -> Measurement:
    begin_s, cpu = time.monotonic(), [cpu_s(pid) for pid in pids]
    bytes_before, rates, factors = wire.received_bytes, list[float](), list[float]()
    memory: tuple[list[tuple[float, float]], ...] = ([], [])
    while (now_s := time.monotonic() - begin_s) < 60.0 * minutes:
        for samples, pid in zip(memory, pids, strict=True):
            samples.append((now_s, resident_MB(pid)))
        was_moving, batches, window_s = _is_moving(served), wire.batches, time.monotonic()
        page.wait_for_timeout(1e3 * WINDOW_S)
        window_s = time.monotonic() - window_s
        if was_moving and _is_moving(served):
            rates.append((wire.batches - batches) / window_s)
            factors.append(float(str(served.state()["real_time_factor"])))
    elapsed_s = time.monotonic() - begin_s
    shares = [(cpu_s(pid) - before) / elapsed_s for pid, before in zip(pids, cpu, strict=True)]
    growth = [growth_per_min(samples[int(WARM_UP_SHARE * len(samples)) :]) for samples in memory]
    return Measurement(
        first_frame_s=first_frame_s,
        poses_hz=sorted(rates)[len(rates) // 2],
        real_time_factor=sorted(factors)[len(factors) // 2],
        traffic_kBps=(wire.received_bytes - bytes_before) / elapsed_s / 1e3,
        server_share=shares[0],
        simulation_share=shares[1],
        server_growth_MB_per_min=growth[0],
        simulation_growth_MB_per_min=growth[1],
        server_MB=memory[0][-1][1],
        minutes=elapsed_s / 60.0,
        load=os.getloadavg()[0],
    )


def _is_moving(served: Served) -> bool:
    state = served.state()
    return state["outcome"] is None and state["loading"] is False


def main() -> int:
    """Exit code 1 when a figure misses its target."""
    parser = argparse.ArgumentParser(prog="python -m tests.app.measure_page", description=__doc__)
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--viewers", type=int, default=1, help="pages open at once")
    parser.add_argument("--scenario", default="ur5_linear")
    parser.add_argument("--compare", metavar="METHOD", help="with the same trial under another method beside it")
    parser.add_argument("--json", action="store_true", help="one JSON object instead of a table")
    options = parser.parse_args()
    with serve("--no-tour", "--scenario", options.scenario, module=("run_server.py",)) as served:
        while served.state()["tick"] is None:
            time.sleep(0.2)
        if options.compare:
            served.command(kind="restart", scenario=options.scenario, compare=options.compare)
        result = measure(served, options.minutes, options.viewers)
    met = {
        "first_frame_s": result.first_frame_s <= FIRST_FRAME_S,
        "poses_hz": result.poses_hz >= 0.95 * POSES_HZ,
        "traffic_kBps": result.traffic_kBps <= TRAFFIC_KBPS,
        "server_share": result.server_share <= (SERVER_SHARE if options.viewers == 1 else SERVER_SHARE_OF_SEVERAL),
    }
    if options.json:
        print(json.dumps(asdict(result) | {"met": met}))
    else:
        for name, value in asdict(result).items():
            mark = "" if name not in met else "  ok" if met[name] else "  MISSED"
            print(f"{name:30} {value:10.2f}{mark}")
    return 0 if all(met.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
