"""Choices that commands share: which robots and objects, how many workers."""

import argparse
import os
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from backend.errors import InvalidInputError, MissingResourceError, lookup
from backend.objects import OBJECTS, object_names
from backend.robots import ROBOTS

UP_TO_DATE = "up to date; --again makes it anew"
Names = ParamSpec("Names")
Found = TypeVar("Found")


def chosen_robots(options: argparse.Namespace) -> list[str]:
    """The robot of ``--robot``, or all; raises ``NotFoundError``."""
    if options.robot is None:
        return list(ROBOTS)
    lookup("robot", options.robot, ROBOTS)
    return [options.robot]


def chosen_objects(options: argparse.Namespace) -> list[str]:
    """The object of ``--object``, also one of the user's own, or the project's seven; raises ``NotFoundError``."""
    if options.object is None:
        return list(OBJECTS)
    lookup("object", options.object, dict.fromkeys(object_names()))
    return [options.object]


def chosen_pairs(options: argparse.Namespace) -> list[tuple[str, str]]:
    """Robot and object, every chosen one with every other."""
    robots, objects = chosen_robots(options), chosen_objects(options)
    return [(robot, name) for robot in robots for name in objects]


def chosen_workers(options: argparse.Namespace) -> int:
    """The number of ``--workers``, or one per core; raises ``InvalidInputError``."""
    workers = options.workers if options.workers is not None else os.cpu_count() or 1
    if workers < 1:
        raise InvalidInputError(f"--workers must be at least 1 (got {workers})")
    return workers


def shelved(load: Callable[Names, Found], *names: Names.args, **more: Names.kwargs) -> Found | None:
    """What ``load`` finds under these names; None when it was not built, or is broken."""
    try:
        return load(*names, **more)
    except (MissingResourceError, InvalidInputError):
        return None
