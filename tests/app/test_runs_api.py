"""Laws of the runs API over HTTP: bounded, checked, and a grid that is begun here ends well."""

from __future__ import annotations

import re
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from backend.experiments.grid.folder import read_grid
from tests.app.served import Served, serve
from tests.experiments.grid.making import all_jobs, plan, row_of, store_in

pytestmark = [pytest.mark.timeout(240), pytest.mark.xdist_group("served")]
OF = plan(trials=4)
TINY = {"robots": ["ur5_robotiq"], "tasks": ["linear"], "objects": ["cube"], "methods": ["ik"], "workers": 1}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("runs")
    for name in ("done", "half"):
        with store_in(root / name, OF) as store:
            for job in all_jobs(OF)[: 8 if name == "done" else 3]:
                store.add(row_of(job))
    (root / "foreign").mkdir()
    (root / "broken").mkdir()
    (root / "broken" / "grid.sqlite").write_bytes(b"no database" * 1000)
    return root


@pytest.fixture(scope="module")
def served(folder: Path) -> Iterator[Served]:
    with serve("--paused", "--no-auto-next", "--no-tour", "--runs", str(folder)) as server:
        yield server


def ask(served: Served, path: str, body: object = None) -> httpx.Response:
    address = served.address.rstrip("/") + "/api/v1" + path
    return httpx.get(address, timeout=60.0) if body is None else httpx.post(address, json=body, timeout=60.0)


def test_every_folder_is_listed_and_the_broken_breaks_nothing(served: Served) -> None:
    runs = {run["name"]: run for run in ask(served, "/runs").json()["runs"]}
    assert {name: run["state"] for name, run in runs.items()} == {
        "broken": "unreadable",
        "done": "complete",
        "foreign": "foreign",
        "half": "stopped",
    }
    assert (runs["half"]["done"], runs["half"]["trials"], runs["done"]["successes"]) == (3, 8, 4)
    assert "is corrupt" in runs["broken"]["note"]
    assert "is corrupt" in ask(served, "/runs/broken").json()["note"]
    for path in ("/runs/broken/rows", "/runs/broken/report"):
        answer = ask(served, path)
        assert answer.status_code == 422 and "is corrupt" in answer.json()["error"]
    assert ask(served, "/runs/broken/go-on", {}).status_code == 422


def test_rows_are_filtered_and_bounded(served: Served) -> None:
    page = ask(served, "/runs/done/rows?method=ik&outcome=failure").json()
    assert page["total"] == len(page["rows"]) == 2
    assert {(row["method"], row["strict"], row["reason"]) for row in page["rows"]} == {("ik", False, "timeout")}
    assert page["rows"][0]["link"].startswith("/open?scenario=ur5_linear&seed=")
    for bad in (
        "limit=0",
        "limit=201",
        "offset=-1",
        "outcome=perhaps",
        "order=random",
        "color=red",
        "robot=" + "a" * 65,
    ):
        assert ask(served, f"/runs/done/rows?{bad}").status_code == 422, bad


def test_a_row_is_found_by_its_key(served: Served) -> None:
    state = ask(served, "/runs/done/rows/ur5_robotiq/linear/cube/ik/1").json()
    assert (state["row"]["index"], state["replay"], state["other_code"]) == (1, "elsewhere", True)
    assert httpx.get(served.address.rstrip("/") + state["link"]).headers["location"] == "/viewer/"
    assert "has no row of" in ask(served, "/runs/done/rows/ur5_robotiq/linear/cube/ik/9").json()["error"]


@pytest.mark.parametrize("name", ["..", "%2e%2e", "..%2F..%2Fetc", "%2Fetc", ".hidden", "a%00b", "a" * 65])
def test_no_address_leads_to_another_folder(served: Served, name: str) -> None:
    for path in (f"/runs/{name}", f"/runs/{name}/rows", f"/runs/{name}/report"):
        assert ask(served, path).status_code in (404, 422), path
    assert ask(served, "/runs?dry_run=true", {**TINY, "name": name}).status_code == 422


def test_what_a_grid_would_come_to_is_said_and_nothing_is_written(served: Served, folder: Path) -> None:
    answer = ask(served, "/runs?dry_run=true", {**TINY, "name": "new", "trials": 30})
    assert answer.status_code == 200
    assert (answer.json()["trials"], answer.json()["workers"], answer.json()["words"]) == (30, 1, "about 1 min")
    assert not (folder / "new").exists()
    wrong = ask(
        served, "/runs?dry_run=true", {"name": "new", "robots": ["ur6"], "trials": 0, "colour": "red", "set": ["x"]}
    )
    assert wrong.status_code == 422
    for words in ("no robot named 'ur6'", "body.trials", "body.colour"):
        assert words in wrong.json()["error"]
    other = ask(served, "/runs", {"name": "half", "trials": 5})
    assert other.status_code == 422 and "has rows of other settings" in other.json()["error"]


def test_a_report_is_made_and_kept(served: Served) -> None:
    first = ask(served, "/runs/done/report?judge=authors").json()
    begun_s = time.monotonic()
    assert ask(served, "/runs/done/report?judge=authors").json() == first
    assert time.monotonic() - begun_s < 5.0
    assert (first["rows"], first["judge"]) == (8, "authors")
    assert {"table_ur5_robotiq", "pairs", "cells"} <= {table["name"] for table in first["tables"]}
    assert all(figure["data"] and "layout" in figure for figure in first["figures"])
    assert ask(served, "/runs/half/report").json()["rows"] == 3


def test_the_page_and_its_parts_are_served(served: Served) -> None:
    page = httpx.get(served.address + "experiments")
    addresses = re.findall(r'(?:src|href)="([^"]*)"', page.text)
    assert page.status_code == 200 and len(addresses) > 5
    assert all(address.startswith("/") and not address.startswith("//") for address in addresses)
    for address in [*addresses, "/experiments/plotly.js"]:
        assert httpx.get(served.address.rstrip("/") + address, follow_redirects=True).status_code == 200, address


def test_every_path_is_described_with_an_example(served: Served) -> None:
    described = httpx.get(served.address + "api/openapi.json").json()
    paths = {path for path in described["paths"] if path.startswith("/api/v1/runs")}
    assert len(paths) == 7
    body = described["paths"]["/api/v1/runs"]["post"]["requestBody"]["content"]["application/json"]
    assert set(body["examples"]) == {"small", "paper"}
    schemas = described["components"]["schemas"]
    for name in ("RunSummary", "EstimateState"):
        (example,) = schemas[name]["examples"]
        assert set(example) == set(schemas[name]["properties"])
    assert schemas["RowState"]["properties"]["no_link"]["description"] == "Why there is none."


def run_of(served: Served, name: str, ready: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    deadline = time.monotonic() + 100.0
    while not ready(run := ask(served, f"/runs/{name}").json()):
        assert time.monotonic() < deadline, f"not reached: {run}"
        time.sleep(0.2)
    return run


def test_a_grid_is_begun_watched_stopped_gone_on_with_and_ends_with_the_server(tmp_path: Path) -> None:
    with serve("--paused", "--no-auto-next", "--runs", str(tmp_path)) as served:
        assert ask(served, "/runs").json()["runs"] == []
        assert ask(served, "/runs", {**TINY, "name": "tiny", "trials": 300}).status_code == 202
        assert run_of(served, "tiny", lambda run: run["own"])["state"] == "running"
        busy = ask(served, "/runs", {**TINY, "name": "other", "trials": 1})
        assert busy.status_code == 409 and "tiny is running" in busy.json()["error"]
        run = run_of(served, "tiny", lambda run: run["done"] >= 3 and run["per_s"] is not None)
        assert run["per_s"] > 0.0 and run["left_s"] > 0.0 and run["trials"] == 300
        assert ask(served, "/runs/tiny/stop", {}).json()["stopping"] is True
        stopped = run_of(served, "tiny", lambda run: run["state"] == "stopped")
        assert stopped["last_words"] == "" and not stopped["own"]
        assert ask(served, "/runs/tiny/stop", {}).status_code == 404
        assert ask(served, "/runs/tiny/go-on", {"workers": 1}).status_code == 202
        run_of(served, "tiny", lambda run: run["done"] > stopped["done"])
        served.process.send_signal(signal.SIGINT)
        output, _ = served.process.communicate(timeout=90.0)
        assert served.process.returncode == 0 and "Finishing the trials under way of tiny" in output
    with read_grid(tmp_path / "tiny") as store:
        rows = list(store.rows())
    assert stopped["done"] < len(rows) < 300 and all(row.reason != "error" for row in rows)


def test_a_grid_that_cannot_go_on_says_why(tmp_path: Path) -> None:
    with serve("--paused", "--runs", str(tmp_path)) as served:
        (tmp_path / "odd" / ".grid.sqlite.lock").mkdir(parents=True)
        assert ask(served, "/runs", {**TINY, "name": "odd", "trials": 1}).status_code == 202
        run = run_of(served, "odd", lambda run: run["last_words"] != "")
        assert "Cannot write to the folder" in run["last_words"] and run["state"] == "foreign" and not run["own"]
