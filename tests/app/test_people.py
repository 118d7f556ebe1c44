"""Laws of sharing one simulation: one drives, the others watch, and nobody is left without a way to drive."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.people import LEASE_S, NEWCOMER, SCRIPT, NotDrivingError, People, Visitor
from app.ui.who import line_html


class Clock:
    """Stands still until told."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_the_first_visitor_drives_and_later_ones_watch() -> None:
    people = People()
    first, second, third = people.arrive(), people.arrive(), people.arrive()
    assert people.driver is first
    assert (people.visitors, people.watching) == (3, 2)
    for watcher in (second, third):
        assert not people.may(watcher)
        with pytest.raises(NotDrivingError, match=r"Visitor 1 drives and you watch.*Take control"):
            people.admit(watcher)
    assert people.driver is first


def test_whoever_takes_control_drives_and_the_former_driver_watches() -> None:
    people = People()
    first, second = people.arrive(), people.arrive()
    people.take(second)
    assert people.driver is second and not people.may(first)
    people.take(first)
    assert people.driver is first


def test_when_the_driver_leaves_the_next_who_asks_drives() -> None:
    people = People()
    first, second, third = people.arrive(), people.arrive(), people.arrive()
    people.leave(first)
    assert people.driver is None and people.may(second) and people.may(third)
    people.admit(third)
    assert people.driver is third and not people.may(second)


def test_the_only_one_left_drives_without_asking() -> None:
    people = People()
    first, second = people.arrive(), people.arrive()
    people.leave(first)
    assert people.driver is second
    people.leave(second)
    assert people.driver is None and people.visitors == 0
    assert people.arrive() == people.driver


def test_a_watcher_who_leaves_changes_nothing() -> None:
    people = People()
    first, second = people.arrive(), people.arrive()
    people.leave(second)
    people.leave(second)
    assert people.driver is first and people.watching == 0


def test_a_script_drives_while_it_sends_commands_and_no_longer() -> None:
    clock = Clock()
    people = People(clock)
    people.admit(SCRIPT)
    visitor = people.arrive()
    for _ in range(5):
        clock.now_s += 0.9 * LEASE_S
        assert people.driver is SCRIPT
        with pytest.raises(NotDrivingError, match="A script drives"):
            people.admit(visitor)
        people.admit(SCRIPT)
    clock.now_s += LEASE_S
    assert people.driver is visitor


def test_a_script_cannot_push_a_visitor_aside_without_saying_so() -> None:
    people = People()
    visitor = people.arrive()
    with pytest.raises(NotDrivingError, match="/api/v1/session/driver"):
        people.admit(SCRIPT)
    people.take(SCRIPT)
    assert not people.may(visitor)
    people.release(visitor)
    assert people.driver is SCRIPT
    people.release(SCRIPT)
    assert people.driver is visitor


def test_the_wheel_is_kept_for_the_page_that_is_about_to_open_but_not_for_ever() -> None:
    clock = Clock()
    people = People(clock)
    old = people.arrive()
    people.take(NEWCOMER)
    assert not people.may(old)
    new = people.arrive()
    assert people.driver is new
    people.take(NEWCOMER)
    people.leave(new)
    clock.now_s += LEASE_S
    assert people.driver is old


def test_a_page_is_known_by_its_key_only_while_it_is_open() -> None:
    people = People()
    visitor = people.arrive()
    assert people.known(visitor.key) is visitor
    for wrong in ("", visitor.key[:-1], visitor.key + "x", "ü€"):
        assert people.known(wrong) is None
    people.leave(visitor)
    assert people.known(visitor.key) is None


STEPS = st.lists(st.tuples(st.sampled_from(("arrive", "leave", "admit", "take", "script", "wait")), st.integers(0, 4)))


@given(STEPS)
def test_whatever_happens_at_most_one_drives_and_a_driver_is_here(steps: list[tuple[str, int]]) -> None:
    clock = Clock()
    people = People(clock)
    here: list[Visitor] = []
    for what, number in steps:
        one = here[number % len(here)] if here else None
        if what == "arrive":
            here.append(people.arrive())
        elif what == "leave" and one is not None:
            here.remove(one)
            people.leave(one)
        elif what == "admit" and one is not None:
            before = people.driver
            if people.may(one):
                people.admit(one)
                assert people.driver is one
            else:
                with pytest.raises(NotDrivingError):
                    people.admit(one)
                assert people.driver is before
        elif what == "take" and one is not None:
            people.take(one)
            assert people.driver is one
        elif what == "script":
            people.take(SCRIPT)
        elif what == "wait":
            clock.now_s += number
        driver = people.driver
        assert driver in (None, SCRIPT, *here)
        assert people.visitors == len(here)
        assert people.watching == len(here) - (driver in here)
        assert [visitor for visitor in here if people.may(visitor)] == (
            [driver] if driver in here else [] if driver else here
        )


def test_the_line_says_who_this_page_is_who_drives_and_how_many_watch() -> None:
    me, other = Visitor("Visitor 1", "k1"), Visitor("<b>", "k2")
    assert "Visitor 1: you drive, nobody watches" in line_html(me, me, 0)
    assert "you drive, 3 watch" in line_html(me, me, 3)
    watching = line_html(me, other, 1)
    assert "you watch, &lt;b&gt; drives, 1 watches" in watching and 'data-visitor="k1"' in watching
    assert "nobody drives, use any control to" in line_html(me, None, 2)
