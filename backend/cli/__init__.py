"""The commands of ``python -m backend``. Each command imports what it needs when it runs, so help is instant."""

import argparse
import importlib
import sys
from collections.abc import Sequence

from backend import __version__
from backend.cli.reports import REPORTS
from backend.errors import GraspingError

INTERRUPTED = 130
MISUSE = 2


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 when it succeeded, 1 when a trial failed, 2 for misuse, 130 when interrupted."""
    options = _parser().parse_args(arguments)
    try:
        return importlib.import_module(f"backend.cli.{options.command}").run(options)
    except GraspingError as error:
        print(f"{options.command}: {error}", file=sys.stderr)
        return MISUSE
    except BaseException as error:
        if not _is_interrupt(error):
            raise
        print(f"\n{options.command}: interrupted; nothing was left half-written.", file=sys.stderr)
        return INTERRUPTED


def _is_interrupt(error: BaseException | None) -> bool:
    """Whether Ctrl-C is behind an exception: compiled code may wrap it in another."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m backend", description="Grasp moving objects, headless.")
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    trial = commands.add_parser("trial", help="run one trial")
    trial.add_argument("scenario", help="name of a file in scenarios/, or the path of one")
    trial.add_argument("--seed", type=int, help="which trial; default: the scenario's seed")
    trial.add_argument("--set", dest="overrides", action="append", default=[], metavar="PATH=VALUE")
    trial.add_argument("--trace", metavar="FILE", help="write the whole trial to FILE, for `replay`")
    _json(trial)

    replay = commands.add_parser("replay", help="run a traced trial, or one of a grid, again and compare it")
    replay.add_argument("what", metavar="FILE|FOLDER", help="a trace, or the folder of a grid")
    replay.add_argument("key", nargs="?", metavar="KEY", help="which trial: ROBOT/TASK/OBJECT/METHOD/INDEX")
    _json(replay)

    render = commands.add_parser("render", help="a traced trial as a film, GIF or MP4")
    render.add_argument("trace", metavar="TRACE", help="as `trial --trace` and the page write it")
    render.add_argument("--out", required=True, metavar="FILE", help="ends in .gif or .mp4")
    render.add_argument("--width", type=int, metavar="PX", help="16:9; default: 640 (GIF), 960 (MP4)")
    render.add_argument("--speed", type=float, default=1.0, metavar="X", help="times that of the trial (default 1)")
    _json(render)

    _grid(commands.add_parser("grid", help="the whole experiment: paired trials, kept row by row, resumable"))
    _merge(commands.add_parser("merge", help="put the rows of a grid's shards together"))

    export = commands.add_parser("export", help="the rows of a grid as Parquet and CSV")
    export.add_argument("folder", metavar="FOLDER")
    export.add_argument("--to", metavar="FOLDER", help="default: the grid's own")
    _json(export)
    _trials(commands.add_parser("trials", help="how trials begin, as a table that others can run"))

    survey = commands.add_parser("survey", help="success of scenarios x objects x seeds, with reasons")
    survey.add_argument("--scenarios", nargs="+", metavar="NAME", help="default: all")
    survey.add_argument("--objects", nargs="+", metavar="NAME", help="default: the seven of the project")
    survey.add_argument("--seeds", type=int, default=5, metavar="N", help="seeds 0 to N-1 (default 5)")
    survey.add_argument("--set", dest="overrides", action="append", default=[], metavar="PATH=VALUE")
    survey.add_argument("--workers", type=int, default=None, metavar="N", help="default: one per core")
    survey.add_argument("--out", metavar="FILE", help="write every trial as a line of JSON")
    _json(survey)

    _build(commands.add_parser("build", help="make what the robot knows beforehand"))
    _report(commands.add_parser("report", help="of a grid; or measure what the robot knows beforehand"))
    _object(commands.add_parser("object", help="bring your own objects: add, remove, list"))

    bench = commands.add_parser("bench", help="time of each room and stepping rate; or all of motion; or lifts")
    bench.add_argument("what", nargs="?", choices=["rooms", "motion", "lifts"], default="rooms")
    bench.add_argument("--scenario", default="ur5_linear")
    bench.add_argument("--trials", type=int, default=5, metavar="N")
    bench.add_argument("--quick", action="store_true", help="motion, lifts: very few cases, to see that it works")
    bench.add_argument("--figures", metavar="FOLDER", help="motion: also draw, into this folder")
    _json(bench)

    warm = commands.add_parser("warm", help="make robot models and compiled kernels once, for quick first starts")
    _json(warm)

    info = commands.add_parser("info", help="list robots, objects, tasks, methods, scenarios and versions")
    _json(info)
    return parser


def _grid(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", nargs="?", metavar="FILE", help="a grid file (TOML) with the words of these flags")
    parser.add_argument("--out", metavar="FOLDER", help="where the rows are kept; run again, it goes on there")
    parser.add_argument("--robots", nargs="+", metavar="NAME", help="default: all")
    parser.add_argument("--tasks", nargs="+", metavar="NAME", help="default: the seven of the paper")
    parser.add_argument("--objects", nargs="+", metavar="NAME", help="default: the seven of the project")
    parser.add_argument("--methods", nargs="+", metavar="NAME", help="default: the six of the paper's table")
    parser.add_argument("--trials", type=int, metavar="N", help="of each robot, task, object and method (default 100)")
    parser.add_argument("--first-seed", type=int, metavar="N", help="of trial 0 (default 0)")
    parser.add_argument("--profile", choices=["paper", "datasheet"], help="joint speeds (default paper)")
    parser.add_argument("--think", choices=["budget", "paper"], help="what a cycle is charged (default budget)")
    parser.add_argument("--judge", choices=["strict", "authors"], help="whose success is shown (default strict)")
    parser.add_argument("--set", action="append", metavar="PATH=VALUE", help="a condition of every trial")
    parser.add_argument("--trials-file", metavar="CSV", help="how trials begin, as `trials export` writes it")
    parser.add_argument("--workers", type=int, metavar="N", help="default: one per core")
    parser.add_argument("--executor", choices=["local", "ray"], help="where trials run (default local)")
    parser.add_argument("--ray-address", metavar="HOST:PORT", help="a running cluster; default: one is started here")
    parser.add_argument("--limit-s", type=float, metavar="S", help="a trial that takes longer is stuck (default 300)")
    parser.add_argument("--shard", metavar="I/N", help="run this part only; `merge` puts the parts together")
    parser.add_argument("--dry-run", action="store_true", help="only say how many trials, and about how long")
    _json(parser)


def _merge(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="FOLDER", help="whose shards are put together, and where everything goes")
    parser.add_argument("others", nargs="*", metavar="OTHER", help="more folders with rows of the same grid")
    parser.add_argument("--salvage", action="store_true", help="take what can be read of corrupt files")
    _json(parser)


def _trials(parser: argparse.ArgumentParser) -> None:
    kinds = parser.add_subparsers(dest="what", required=True, metavar="WHAT")
    export = kinds.add_parser("export", help="write the starts of a scenario's trials as CSV")
    export.add_argument("file", metavar="CSV")
    export.add_argument("--task", nargs="+", required=True, metavar="NAME", help="scenarios, such as ur5_linear")
    export.add_argument("--objects", nargs="+", metavar="NAME", help="default: each scenario's own")
    export.add_argument("--n", type=int, default=100, metavar="N", help="of each object (default 100)")
    export.add_argument("--first-seed", type=int, default=0, metavar="N", help="of the first trial (default 0)")
    _json(export)


def _build(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("what", choices=["grasps", "reachability", "motion-aware", "predictor"])
    parser.add_argument("--robot", metavar="NAME", help="default: all")
    parser.add_argument("--object", metavar="NAME", help="default: the seven of the project (grasps, motion-aware)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--again", action="store_true", help="also what is up to date already")
    parser.add_argument("--count", type=int, default=100, help="grasps to keep (default 100; grasps only)")
    parser.add_argument(
        "--attempts", type=int, default=10_000, metavar="N", help="of each pair (default 10000; motion-aware only)"
    )
    parser.add_argument("--workers", type=int, metavar="N", help="default: one per core (all but predictor)")
    _json(parser)


def _report(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "what", metavar="FOLDER|WHAT", help=f"a grid's folder, or one of {', '.join(REPORTS)}, knowledge"
    )
    parser.add_argument("--judge", choices=["strict", "authors"], help="default: the grid's own (grids only)")
    parser.add_argument("--to", metavar="FOLDER", help="default: report/ in the grid's folder (grids only)")
    parser.add_argument(
        "--motions", type=int, default=3, metavar="N", help="of each family (default 3; prediction only)"
    )
    parser.add_argument("--families", nargs="+", metavar="NAME", help="default: all")
    parser.add_argument("--robot", metavar="NAME", help="default: all (all but prediction)")
    parser.add_argument("--object", metavar="NAME", help="default: the seven (grasps, motion-aware)")
    parser.add_argument(
        "--attempts", type=int, default=0, metavar="N", help="fresh ones as well (default 0; motion-aware only)"
    )
    parser.add_argument("--workers", type=int, metavar="N", help="default: one per core (motion-aware only)")
    parser.add_argument("--poses", type=int, default=100_000, metavar="N", help="default 100000 (reachability only)")
    parser.add_argument("--figures", metavar="FOLDER", help="also draw grasps, slices and curves there")
    parser.add_argument(
        "--lifts", type=int, default=0, metavar="N", help="timed, of each pair (default 0; grasps only)"
    )
    parser.add_argument("--seed", type=int, default=0)
    _json(parser)


def _object(parser: argparse.ArgumentParser) -> None:
    kinds = parser.add_subparsers(dest="what", required=True, metavar="WHAT")

    add = kinds.add_parser("add", help="make an object of a mesh (OBJ, STL, PLY or GLB)")
    add.add_argument("mesh", metavar="FILE")
    add.add_argument("--name", required=True, help="lower-case letters, digits and _")
    add.add_argument("--mass-kg", type=float, required=True, metavar="KG")
    add.add_argument("--scale", type=float, default=1.0, metavar="M", help="metres per unit of the file (default 1)")
    add.add_argument("--title", metavar="TEXT", help="default: made of the name")
    add.add_argument("--upright", action="store_true", help="keep the file's z up (GLB: its y); default: as it rests")
    add.add_argument("--color", default="#9aa7b4", metavar="#RRGGBB")
    add.add_argument("--friction", type=float, default=0.7, metavar="MU", help="times the pads' own (default 0.7)")
    add.add_argument("--parts", type=int, default=24, metavar="N", help="convex parts at most (default 24)")
    add.add_argument("--concavity", type=float, default=0.05, metavar="C", help="less cuts closer (default 0.05)")
    add.add_argument("--seed", type=int, default=0)
    add.add_argument("--replace", action="store_true", help="take the place of an own object of that name")
    _json(add)

    remove = kinds.add_parser("remove", help="take away an object of your own, and its grasps")
    remove.add_argument("name", metavar="NAME")
    _json(remove)

    _json(kinds.add_parser("list", help="every object, and for which robots it has grasps"))


def _json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")
