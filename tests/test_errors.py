"""Errors say what was asked, what exists, and what was probably meant."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import (
    GraspingError,
    InvalidInputError,
    MissingResourceError,
    NotFoundError,
    SimulationError,
    lookup,
    not_found_text,
)

TABLE = {"mico": 1, "ur5_robotiq": 2}


def test_a_known_name_is_found():
    assert lookup("robot", "mico", TABLE) == 1


def test_an_unknown_name_is_answered_with_all_names_and_the_nearest():
    with pytest.raises(NotFoundError) as caught:
        lookup("robot", "ur5_robotic", TABLE)
    assert str(caught.value) == (
        "There is no robot named 'ur5_robotic'. Available: mico, ur5_robotiq. Did you mean 'ur5_robotiq'?"
    )


def test_nothing_near_gives_no_hint():
    assert not_found_text("robot", "zzz", TABLE) == "There is no robot named 'zzz'. Available: mico, ur5_robotiq."


def test_an_empty_table_says_so():
    assert not_found_text("robot", "mico", ()) == "There is no robot named 'mico'. Available: (none)."


@pytest.mark.parametrize("kind", [NotFoundError, InvalidInputError, MissingResourceError, SimulationError])
def test_all_errors_are_of_one_tree(kind: type[Exception]):
    assert issubclass(kind, GraspingError)


@given(st.dictionaries(st.text(min_size=1), st.integers(), max_size=8), st.text())
def test_lookup_finds_exactly_what_the_table_holds(table: dict[str, int], name: str):
    if name in table:
        assert lookup("thing", name, table) == table[name]
    else:
        with pytest.raises(NotFoundError):
            lookup("thing", name, table)
