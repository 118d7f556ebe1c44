"""For all tests of the page: a session of the fake engine, and the robots' models, made once per machine."""

from collections.abc import Iterator

import pytest

from app.session import Session
from backend.robots import ROBOTS
from backend.robots.models import load_model
from tests.app.fake_episode import LINEAR, FakeEngine


@pytest.fixture(scope="session", autouse=True)
def models_are_made() -> None:
    for robot in ROBOTS:
        load_model(robot)


@pytest.fixture
def session() -> Iterator[Session]:
    session = Session(FakeEngine(), LINEAR, paused=True)
    session.start()
    yield session
    session.close()
