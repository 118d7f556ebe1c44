"""``object``: bring one's own objects, list them, and take them away again."""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from backend.cli.telling import Teller
from backend.errors import InvalidInputError, NotFoundError, not_found_text
from backend.files import remove
from backend.knowledge.grasps import grasp_file
from backend.knowledge.pairs import forget
from backend.objects import OBJECTS, ObjectDescription, load_object, object_names
from backend.objects.own import own_file, own_names, save_own
from backend.robots import ROBOTS

LARGE_ERROR = 0.1
"""Of the volume; parts that are this much off are worth another try."""
BUILDS = ("grasps", "motion-aware")
"""What ``build`` makes of an object."""


def run(options: argparse.Namespace) -> int:
    """Do what is asked for; always 0."""
    match options.what:
        case "add":
            return _add(options)
        case "remove":
            return _remove(options)
        case _:
            return _list(options)


def _add(options: argparse.Namespace) -> int:
    from backend.build.own_object import Wanted, make_own

    wanted = Wanted(
        name=options.name,
        mass_kg=options.mass_kg,
        title=options.title,
        scale=options.scale,
        upright=options.upright,
        color=options.color,
        friction=options.friction,
        most_parts=options.parts,
        concavity=options.concavity,
        seed=options.seed,
    )
    if wanted.name in own_names() and not options.replace:
        raise InvalidInputError(
            f"There is an object named {wanted.name!r} already ({own_file(wanted.name)}). "
            "Choose another --name, or say --replace, which also forgets its grasps and models."
        )
    made = make_own(Path(options.mesh), wanted, Teller(wanted.name))
    forget(wanted.name)
    path = save_own(made.described)
    entry = _entry(made.described) | {
        "file": str(path),
        "repairs": list(made.repairs),
        "volume_error": round(made.volume_error, 4),
        "resting_probability": round(made.resting_probability, 4),
        "steady": made.steady,
        "hands": list(made.hands),
        "next": _next(wanted.name, made.hands),
    }
    print(json.dumps({"object": entry}) if options.json else describe_added(entry))
    return 0


def describe_added(entry: dict[str, Any]) -> str:
    """What was found, for people, and the commands that come next."""
    lines = [f"{entry['name']}: {_size(entry)}, {entry['mass_kg']:g} kg ({entry['density_gpcm3']:.2g} g/cm^3)"]
    lines += [f"  repaired: {repair}" for repair in entry["repairs"]]
    lines.append(f"  {entry['parts']} convex parts; their union is {_percent(entry['volume_error'])} than the mesh")
    if abs(entry["volume_error"]) > LARGE_ERROR:
        lines.append("  (closer with --replace --parts 48 --concavity 0.02; many parts make trials slower)")
    drops = 100 * entry["resting_probability"]
    steady = "steady in simulation" if entry["steady"] else "but it may roll or topple on a belt (try --upright)"
    lines.append(f"  lies as {f'{drops:.0f}' if drops >= 1 else 'under 1'} % of random drops end, {steady}")
    others = [name for name in ROBOTS if name not in entry["hands"]]
    lines.append(
        f"  fits the hands of: {', '.join(entry['hands'])}" + (f" (not {', '.join(others)})" if others else "")
    )
    return "\n".join([*lines, f"  kept in {entry['file']}", "Next:", *(f"  {command}" for command in entry["next"])])


def _remove(options: argparse.Namespace) -> int:
    name: str = options.name
    if name in OBJECTS:
        raise InvalidInputError(f"{name} comes with the project and stays; only your own objects can be removed.")
    if name not in own_names():
        raise NotFoundError(not_found_text("object of your own", name, own_names()))
    path = own_file(name)
    forget(name)
    remove(path)
    print(
        json.dumps({"removed": name, "file": str(path)})
        if options.json
        else f"{name}: removed, with its grasps and models"
    )
    return 0


def _list(options: argparse.Namespace) -> int:
    entries = [_listed(name) for name in object_names()]
    if options.json:
        print(json.dumps({"objects": entries}))
        return 0
    for entry in entries:
        grasps = f"grasps for {', '.join(entry['grasps'])}" if entry["grasps"] else "no grasps yet"
        whose = "" if entry["built_in"] else ", your own"
        print(f"{entry['name']}: {entry.get('error') or _facts(entry)}; {grasps}{whose}")
    return 0


def _listed(name: str) -> dict[str, Any]:
    """One row; an object that cannot be read says so there, and hides no other."""
    known = [robot for robot in ROBOTS if grasp_file(robot, name).is_file()]
    row: dict[str, Any] = {"name": name, "built_in": name in OBJECTS, "grasps": known}
    try:
        return _entry(load_object(name)) | row
    except InvalidInputError as error:
        return row | {"error": str(error)}


def _entry(described: ObjectDescription) -> dict[str, Any]:
    return {
        "name": described.name,
        "title": described.title,
        "mass_kg": described.mass_kg,
        "density_gpcm3": round(described.mass_kg / described.visual.volume_m3 / 1000, 3),
        "size_m": [round(side_m, 4) for side_m in np.ptp(described.visual.bounds_m, axis=0).tolist()],
        "parts": len(described.convex_parts),
    }


def _facts(entry: dict[str, Any]) -> str:
    return f"{_size(entry)}, {entry['mass_kg']:g} kg, convex parts: {entry['parts']}"


def _size(entry: dict[str, Any]) -> str:
    return " x ".join(f"{100 * side_m:.1f}" for side_m in entry["size_m"]) + " cm"


def _percent(share: float) -> str:
    return f"{100 * abs(share):.1f} % {'larger' if share >= 0 else 'smaller'}"


def _next(name: str, hands: tuple[str, ...]) -> list[str]:
    """The commands that lead to a trial."""
    robots = [""] if len(hands) == len(ROBOTS) else [f" --robot {robot}" for robot in hands]
    build = [f"python -m backend build {what}{robot} --object {name}" for what in BUILDS for robot in robots]
    return [*build, f"python -m backend trial {hands[-1].split('_')[0]}_linear --set object={name}"]
