"""The running trial: its state, and commands to it."""

from typing import Annotated

from fastapi import APIRouter, Body, Depends
from pydantic import BaseModel

from app.api.control import Asker
from app.api.examples import COMMANDS
from app.commands import Command
from app.people import Visitor
from app.reports import Sight
from app.session import Session
from app.state import SessionState, Status
from backend.pipeline.values import FailureReason, Outcome, Phase
from backend.pose import Pose

Point = tuple[float, float, float]


class OutcomeState(BaseModel):
    """How the trial ended."""

    strict: bool
    authors: bool
    reason: FailureReason | None
    detail: str


class ComparedState(BaseModel):
    """The same trial under the method compared with."""

    method: str
    tick: int
    t_s: float
    phase: Phase
    object_m: Point
    hand_m: Point
    outcome: OutcomeState | None
    fingerprint: str | None


class CrashState(BaseModel):
    """Why the simulation process ended."""

    cause: str
    traceback: str


class State(BaseModel):
    """Answer of /session. What no trial has reached yet is null."""

    simulation: Status
    loading: bool
    scenario: str
    title: str
    robot: str
    object: str
    method: str
    seed: int
    overrides: dict[str, bool | int | float | str]
    paused: bool
    speed: float | None
    real_time_factor: float
    run: int | None
    tick: int | None
    t_s: float | None
    phase: Phase | None
    cycles: int | None
    belt_rate: float | None
    looked_at_s: float | None
    """Simulated time of the earlier moment that the page shows; null when it shows the newest."""
    live_edits: int
    object_m: Point | None
    """Where the object is, in the world."""
    hand_m: Point | None
    """Where the tcp is, in the world."""
    outcome: OutcomeState | None
    fingerprint: str | None
    """Of the whole trial, once it has ended: equal for equal trials, here or headless."""
    compared: ComparedState | None
    crash: CrashState | None
    refused_commands: int
    last_refusal: str


def session_router(session: Session) -> APIRouter:
    """GET /session and POST /session/commands."""
    router = APIRouter(tags=["session"])
    asks = Asker(session.people)

    @router.get("/session")
    def state() -> State:
        """What runs, and how far it is."""
        return describe(session.state)

    @router.post("/session/commands", status_code=202)
    def command(
        command: Annotated[Command, Body(openapi_examples=COMMANDS)], who: Annotated[Visitor, Depends(asks)]
    ) -> State:
        """Ask for something. 409 says that somebody else drives, 422 what is wrong with the command."""
        session.people.admit(who)
        session.send(command)
        return describe(session.state)

    return router


def describe(state: SessionState) -> State:
    """``state`` in plain figures."""
    snapshot = state.snapshot
    return State(
        simulation=state.status,
        loading=state.loading,
        scenario=state.info.scenario,
        title=state.info.title,
        robot=state.info.robot,
        object=state.info.object,
        method=state.info.method,
        seed=state.restart.seed,
        overrides=state.restart.overrides,
        paused=state.pace.paused,
        speed=state.pace.speed,
        real_time_factor=state.pace.real_time_factor,
        run=state.started.run if state.started else None,
        tick=snapshot.tick if snapshot else None,
        t_s=snapshot.t_s if snapshot else None,
        phase=snapshot.phase if snapshot else None,
        cycles=snapshot.cycles if snapshot else None,
        belt_rate=snapshot.belt_rate if snapshot else None,
        looked_at_s=state.looked_at.t_s if state.looked_at else None,
        live_edits=len(state.events),
        object_m=_point(snapshot.T_world_object) if snapshot else None,
        hand_m=_point(snapshot.T_world_tcp) if snapshot else None,
        outcome=_outcome(snapshot.outcome if snapshot else None),
        fingerprint=snapshot.fingerprint if snapshot else None,
        compared=_compared(state.restart.compare, state.beside),
        crash=CrashState(cause=state.crash.cause, traceback=state.crash.traceback) if state.crash else None,
        refused_commands=state.refusals[0],
        last_refusal=state.refusals[1],
    )


def _outcome(outcome: Outcome | None) -> OutcomeState | None:
    return None if outcome is None else OutcomeState.model_validate(outcome, from_attributes=True)


def _compared(method: str | None, beside: Sight | None) -> ComparedState | None:
    if method is None or beside is None:
        return None
    snapshot = beside.snapshot
    return ComparedState(
        method=method,
        tick=snapshot.tick,
        t_s=snapshot.t_s,
        phase=snapshot.phase,
        object_m=_point(snapshot.T_world_object),
        hand_m=_point(snapshot.T_world_tcp),
        outcome=_outcome(snapshot.outcome),
        fingerprint=snapshot.fingerprint,
    )


def _point(T: Pose) -> Point:
    x, y, z = T.xyz_m.tolist()
    return x, y, z
