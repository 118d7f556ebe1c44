"""The laws of the house: who may import whom."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("sense", "predict", "convert", "filter", "pick", "plan", "retime", "execute")
TRAINING = ("motion_aware", "predictor", "predictor_network", "predictor_spread")
HEAVY = {
    "coacd": {"backend/build/convex_parts.py"},
    "torch": {f"backend/build/{what}.py" for what in TRAINING},
    "ompl": {f"backend/pipeline/plan/ompl_{what}.py" for what in ("roadmap", "space", "tree")},
    "toppra": {"backend/pipeline/retime/toppra_pass.py"},
    "ray": {"backend/experiments/executors/ray.py"},
    "duckdb": set[str](),
    "imageio_ffmpeg": {"backend/film/writing.py"},
    "pebble": {"backend/experiments/executors/local.py"},
    "plotly": {"backend/experiments/report/figures.py"},
    "pyarrow": {"backend/experiments/grid/tables.py"},
    "statsmodels": {"backend/experiments/report/statistics.py"},
    "matplotlib": {
        "backend/bench/seeding_figure.py",
        *(f"backend/build/{what}_figure.py" for what in ("grasp", "motion", "reach")),
    },
}


def sources(folder: str) -> list[Path]:
    return sorted((ROOT / folder).rglob("*.py"))


def imports(path: Path) -> set[str]:
    """Every module that a file imports anywhere in it, dotted names with what is imported from them."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module}
    return found


def users(package: str, folder: str) -> set[str]:
    return {
        path.relative_to(ROOT).as_posix()
        for path in sources(folder)
        if any(name.split(".")[0] == package for name in imports(path))
    }


@pytest.mark.parametrize("package", ["app", "viser", "fastapi", "uvicorn"])
def test_backend_knows_no_screen(package: str):
    assert users(package, "backend") == set()


def test_only_one_file_imports_pybullet():
    assert users("pybullet", "backend") | users("pybullet", "app") == {"backend/sim/bullet.py"}


def test_only_the_loop_its_edits_the_senses_and_the_judge_see_the_world():
    seers = {
        path.relative_to(ROOT).as_posix()
        for path in sources("backend")
        if any(name.startswith("backend.sim.world") for name in imports(path))
    }
    allowed = {"backend/pipeline/sense.py", "backend/tasks/judge.py", "backend/cli/bench.py"}
    allowed |= {"backend/episode.py", "backend/editing.py"}
    assert "backend/episode.py" in seers and seers <= allowed


def room_of(module: str) -> int | None:
    parts = module.split(".")
    return (
        ROOMS.index(parts[2]) if parts[:2] == ["backend", "pipeline"] and len(parts) > 2 and parts[2] in ROOMS else None
    )


def test_a_room_never_imports_a_later_one():
    seen = 0
    for path in sources("backend/pipeline"):
        here = room_of(".".join(path.relative_to(ROOT).with_suffix("").parts))
        for name in imports(path):
            there = room_of(name)
            if here is not None and there is not None:
                seen += 1
                assert there <= here, f"{path.name} imports {name}, a later room"
    assert seen > 0


@pytest.mark.parametrize("package", sorted(HEAVY))
def test_heavy_packages_are_imported_where_they_are_needed_only(package: str):
    assert users(package, "backend") <= HEAVY[package]


def test_importing_the_command_line_is_light():
    heavy = [*HEAVY, "numba", "pybullet", "trimesh", "viser", "numpy"]
    code = f"import sys, backend.cli; print([m for m in {heavy!r} if m in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert answer.stdout.strip() == "[]"


def test_the_server_leaves_the_engine_to_the_simulation_process():
    heavy = ("pybullet", "numba", "ompl", "toppra", "torch")
    code = f"import sys, app.serve; print([m for m in {heavy!r} if m in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert answer.stdout.strip() == "[]"


def test_there_are_no_circles_of_imports():
    modules = {
        ".".join(p.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): p for p in sources("backend")
    }
    graph = {name: top_level_imports(path) & set(modules) - {name} for name, path in modules.items()}
    done: set[str] = set()

    def visit(name: str, trail: tuple[str, ...]) -> None:
        assert name not in trail, " -> ".join((*trail[trail.index(name) :], name))
        if name not in done:
            for other in sorted(graph[name]):
                visit(other, (*trail, name))
            done.add(name)

    for name in sorted(graph):
        visit(name, ())


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def top_level_imports(path: Path) -> set[str]:
    """What a module imports while it is itself being imported; packages count by the names taken from them."""
    found: set[str] = set()
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module}
    return found


def test_no_module_holds_mutable_state():
    for path in [*sources("backend"), *sources("app")]:
        for node in ast.walk(ast.parse(path.read_text())):
            assert not isinstance(node, ast.Global), f"{path}: global {node.names}"


def test_no_global_random_generator():
    for path in sources("backend"):
        text = path.read_text()
        for call in ("np.random.rand(", "np.random.seed(", "np.random.normal(", "random.random()", "random.seed("):
            assert call not in text.replace("rng.random()", "").replace("_rng.random()", ""), f"{path}: {call}"


def test_rooms_have_telling_names():
    names = {path.stem for path in [*sources("backend"), *sources("app")]}
    assert names.isdisjoint({"utils", "util", "helpers", "helper", "common", "manager", "misc"})
