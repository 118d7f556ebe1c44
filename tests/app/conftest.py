"""For all tests of the page: a session of the fake engine, a bare viser, and the robots' models, made once."""

from collections.abc import Iterator

import pytest
import viser

from app.session import Session
from app.ui.start import start_viser
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


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = start_viser()
    yield server
    server.stop()
