"""``info``: what there is, by name, and the versions it runs on."""

import argparse
import json
import platform
from importlib.metadata import version

from backend import __version__
from backend.methods import METHODS
from backend.objects import object_names
from backend.robots import ROBOTS
from backend.scenario import scenario_names
from backend.tasks import TASKS

PACKAGES = ("pybullet", "numpy", "numba", "ompl", "toppra", "torch", "trimesh", "coacd", "viser", "fastapi")


def run(options: argparse.Namespace) -> int:
    """Print names and versions; always 0."""
    table: dict[str, object] = {
        "robots": list(ROBOTS),
        "objects": list(object_names()),
        "tasks": list(TASKS),
        "methods": list(METHODS),
        "scenarios": scenario_names(),
        "versions": {
            "dynamic-grasping": __version__,
            "python": platform.python_version(),
            **{package: version(package) for package in PACKAGES},
        },
    }
    if options.json:
        print(json.dumps(table))
        return 0
    for kind, entries in table.items():
        print(f"{kind}:")
        if isinstance(entries, dict):
            print("".join(f"  {name} {text}\n" for name, text in entries.items()), end="")
        else:
            print("".join(f"  {name}\n" for name in entries), end="")  # pyright: ignore
    return 0
