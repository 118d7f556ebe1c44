"""Scenario files: every ``scenarios/*.toml`` is one."""

from __future__ import annotations

import tomllib
from pathlib import Path

from backend.errors import InvalidInputError, NotFoundError, lookup
from backend.methods import METHODS
from backend.scenario.model import Scenario, differences
from backend.scenario.parse import parse_scenario
from backend.scenario.toml import to_toml_text

SCENARIOS_DIR = Path(__file__).resolve().parents[2] / "scenarios"


def scenario_names() -> tuple[str, ...]:
    """Names of the project's scenario files, in alphabetical order."""
    return tuple(sorted(_files()))


def load_scenario(name_or_path: str | Path) -> Scenario:
    """The scenario of that name, or of the file at that path (which ends in ``.toml``).

    Raises ``NotFoundError`` naming what exists, or ``InvalidInputError`` naming file, key and bound.
    """
    path = Path(name_or_path)
    if path.suffix != ".toml" and len(path.parts) == 1:
        path = lookup("scenario", str(name_or_path), _files())
    return parse_scenario(_read(path), shown(path))


def to_toml(scenario: Scenario) -> str:
    """Text of a scenario file that ``load_scenario`` reads back as an equal scenario."""
    table = scenario.model_dump(exclude_none=True)
    method = METHODS[scenario.method.name].model_dump()
    changes = differences(method, table["method"])
    table["method"] = {"name": scenario.method.name, **changes} if changes else scenario.method.name
    return to_toml_text({key: value for key, value in table.items() if value != ()})


def shown(path: Path) -> str:
    """How messages call the file: from the project's folder on, where it lies in there."""
    resolved, home = path.resolve(), SCENARIOS_DIR.parent
    return str(resolved.relative_to(home)) if resolved.is_relative_to(home) else str(path)


def _files() -> dict[str, Path]:
    return {path.stem: path for path in SCENARIOS_DIR.glob("*.toml")}


def _read(path: Path) -> dict[str, object]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        text = f"There is no scenario file {path}. Available by name: {', '.join(scenario_names())}."
        raise NotFoundError(text) from None
    except OSError as error:
        raise InvalidInputError(f"{shown(path)}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InvalidInputError(f"{shown(path)}: not UTF-8 text (byte {error.start})") from None
    except tomllib.TOMLDecodeError as error:
        raise InvalidInputError(f"{shown(path)}: not valid TOML: {error}") from None
