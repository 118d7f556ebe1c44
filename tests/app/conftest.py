"""The robots' models are made once per machine; that is not what the tests of the page wait for."""

import pytest

from backend.robots import ROBOTS
from backend.robots.models import load_model


@pytest.fixture(scope="session", autouse=True)
def models_are_made() -> None:
    for robot in ROBOTS:
        load_model(robot)
