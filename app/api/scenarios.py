"""Which scenarios exist."""

from fastapi import APIRouter
from pydantic import BaseModel

from app.commands import Restart
from app.engine import Engine


class ScenarioEntry(BaseModel):
    """One scenario as its file has it."""

    scenario: str
    title: str
    robot: str
    object: str
    task: str
    method: str
    speed_path: str | None
    speed_mps: float | None


class ScenarioList(BaseModel):
    """Answer of /scenarios."""

    scenarios: list[ScenarioEntry]
    objects: list[str]
    methods: list[str]


def scenarios_router(engine: Engine) -> APIRouter:
    """GET /scenarios."""
    router = APIRouter(tags=["scenarios"])

    @router.get("/scenarios")
    def scenarios() -> ScenarioList:
        infos = [engine.describe(Restart(scenario=name, overrides={})) for name in engine.scenario_names()]
        return ScenarioList(
            scenarios=[ScenarioEntry.model_validate(info, from_attributes=True) for info in infos],
            objects=list(engine.object_names()),
            methods=list(engine.method_names()),
        )

    return router
