"""Ray, where it is installed: the rows of the local executor, whatever happens to actors and nodes."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from backend.errors import InvalidInputError
from backend.experiments.executors.ray import RayExecutor
from backend.experiments.grid.folder import read_grid
from tests.experiments.grid import faulty
from tests.experiments.grid.making import all_jobs, plan, row_of

pytest.importorskip("ray")
pytestmark = pytest.mark.timeout(600)

SCRIPT = """
import sys
from pathlib import Path
from ray.cluster_utils import Cluster
from backend.experiments.executors.ray import RayExecutor
from backend.experiments.grid.driver import Stop, drive
from tests.experiments.grid import faulty
from tests.experiments.grid.making import plan, store_in
folder, work, trials, limit_s, lose_a_node = sys.argv[1:]
cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
node = cluster.add_node(num_cpus=1)
of = plan(trials=int(trials))
told = []

def tell(row):
    told.append(row)
    if lose_a_node == "yes" and len(told) == 5:
        cluster.remove_node(node, allow_graceful=False)

with store_in(Path(folder), of) as store:
    executor = RayExecutor(getattr(faulty, work), store.facts.settings, 2, float(limit_s), cluster.address)
    assert drive(of.jobs(lambda key: True), executor, store, Stop(), tell)
    executor.close()
cluster.shutdown()
"""


def run(folder: Path, *words: str) -> None:
    command = [sys.executable, "-c", SCRIPT, str(folder), *words]
    answer = subprocess.run(command, capture_output=True, text=True, check=False, timeout=560)
    assert answer.returncode == 0, answer.stderr[-3000:]


def test_a_lost_node_loses_no_trial(tmp_path: Path):
    run(tmp_path, "slow", "15", "60", "yes")
    of = plan(trials=15)
    with read_grid(tmp_path) as store:
        rows = {row.key: row for row in store.rows()}
        settings = store.facts.settings
    assert rows.keys() == {job.key for job in all_jobs(of)}
    for job in all_jobs(of):
        assert rows[job.key].sure() == row_of(job, settings).sure()


def test_actors_that_crash_hang_or_raise_cost_one_retry_and_one_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv(faulty.ONCE_FILE, str(tmp_path / "once-"))
    run(tmp_path, "work", "6", "5", "no")
    with read_grid(tmp_path) as store:
        rows = {row.key: row for row in store.rows()}
    assert len(rows) == 12
    words = {faulty.CRASHES: "died", faulty.HANGS: "longer than 5 s", faulty.RAISES: "a knot in the arm"}
    for key, row in rows.items():
        assert (row.reason == "error") == (key.index in words)
        assert words.get(key.index, "") in row.detail


def test_an_address_that_does_not_answer_is_named_in_time():
    begun_s = time.monotonic()
    for address in ("127.0.0.1:9", "ray://127.0.0.1:9", "nowhere"):
        with pytest.raises(InvalidInputError, match=address):
            RayExecutor(faulty.work, "", 1, 60.0, address)
    assert time.monotonic() - begun_s < 15.0
