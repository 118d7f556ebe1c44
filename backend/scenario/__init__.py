"""Scenario: one reproducible problem; how it is read, changed and written."""

from backend.scenario.files import SCENARIOS_DIR, load_scenario, scenario_names, to_toml
from backend.scenario.model import Scenario, SensingConfig, TimingConfig
from backend.scenario.overrides import with_overrides
from backend.scenario.parse import parse_scenario

__all__ = [
    "SCENARIOS_DIR",
    "Scenario",
    "SensingConfig",
    "TimingConfig",
    "load_scenario",
    "parse_scenario",
    "scenario_names",
    "to_toml",
    "with_overrides",
]
