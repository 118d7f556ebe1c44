"""Settings of the dashboard: flags win over environment variables, those win over the defaults."""

import argparse
import ipaddress
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import Field, ValidationError, model_validator

from backend.config import Config, explain
from backend.errors import InvalidInputError

ENVIRONMENT_PREFIX = "GRASPING_"


class Settings(Config):
    """Where the page is served, and what it shows first."""

    host: str = "127.0.0.1"
    """Address to listen on; anything beyond this machine needs a token."""
    port: Annotated[int, Field(ge=0, le=65535)] = 8080
    """TCP port; 0 takes any free one and says which."""
    token: Annotated[str, Field(min_length=8, max_length=200, pattern=r"^[ -~]*$")] | None = None
    """Secret of at least 8 plain characters that a browser must bring once, as ?token=..."""
    host_names: str = ""
    """Further host names under which it may be asked for, with commas between."""
    scenario: str = "ur5_linear"
    """First scenario, a file name in scenarios/ without its ending."""
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)] = 0
    """First seed."""
    runs: str = "runs"
    """Folder with the runs of grids that the experiments page shows."""
    paused: bool = False
    """Start paused."""
    auto_next: bool = True
    """Go on with the next seed some seconds after an outcome."""
    low_fx: bool = True
    """No shadows and no environment light: quick without a graphics card."""
    tour: bool = True
    """Show a short tour to whoever opens the page for the first time."""
    max_clients: Annotated[int, Field(ge=1, le=64)] = 8
    """Browsers served at the same time."""

    @model_validator(mode="after")
    def _token_beyond_this_machine(self) -> "Settings":
        if self.token is None and not is_loopback(self.host):
            raise ValueError(
                f"listening on {self.host} lets other machines in, so a token is needed: add --token SECRET, "
                "or stay on --host 127.0.0.1"
            )
        return self


def is_loopback(host: str) -> bool:
    """Whether ``host`` reaches this machine only."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def read_settings(arguments: Sequence[str], environment: Mapping[str, str]) -> Settings:
    """Settings from flags and ``GRASPING_*`` variables; raises ``InvalidInputError`` with name and bound."""
    flags = {k: str(v) for k, v in vars(_parser().parse_args(arguments)).items() if v is not None}
    values = _from_environment(environment) | flags
    try:
        return Settings.model_validate_strings(values)
    except ValidationError as error:
        raise InvalidInputError(explain(error, "settings").replace("Value error, ", "")) from None


def _from_environment(environment: Mapping[str, str]) -> dict[str, str]:
    known = {ENVIRONMENT_PREFIX + name.upper(): name for name in Settings.model_fields}
    return {name: environment[key] for key, name in known.items() if environment.get(key)}


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="run_server.py",
        description="Serve the dashboard. Every flag has an environment variable: GRASPING_PORT=9000.",
    )
    for name, field in Settings.model_fields.items():
        flag = "--" + name.replace("_", "-")
        text = f"{(field.description or '').rstrip('.')} (default: {field.default})"
        if field.annotation is bool:
            action: Any = argparse.BooleanOptionalAction
            parser.add_argument(flag, action=action, default=None, help=text)
        else:
            parser.add_argument(flag, default=None, metavar=name.upper(), help=text)
    return parser
