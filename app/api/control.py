"""Who drives the one simulation: asked, taken and given back."""

from typing import Annotated

from fastapi import APIRouter, Depends, Header
from pydantic import BaseModel

from app.people import SCRIPT, People, Visitor
from app.session import Session


class Asker:
    """Tells whose a request is: that of the page whose key it brings, else a script's."""

    def __init__(self, people: People) -> None:
        self._people = people

    def __call__(self, x_visitor: Annotated[str, Header(max_length=100, include_in_schema=False)] = "") -> Visitor:
        return self._people.known(x_visitor) or SCRIPT


class ControlState(BaseModel):
    """Answer of /session/driver."""

    driver: str | None
    """Whose commands are obeyed; null when it is whoever asks next."""
    visitors: int
    """Open pages."""
    watching: int
    """Of those, the ones that do not drive."""
    you_drive: bool


def control_router(session: Session) -> APIRouter:
    """GET, POST and DELETE /session/driver."""
    router = APIRouter(tags=["session"])
    people = session.people
    asks = Asker(people)

    @router.get("/session/driver")
    def driver(who: Annotated[Visitor, Depends(asks)]) -> ControlState:
        """Who drives, and how many watch."""
        return control_state(people, who)

    @router.post("/session/driver")
    def take(who: Annotated[Visitor, Depends(asks)]) -> ControlState:
        """Take control. A script keeps it until it gives it back, or has sent nothing for 10 s."""
        people.take(who)
        return control_state(people, who)

    @router.delete("/session/driver")
    def release(who: Annotated[Visitor, Depends(asks)]) -> ControlState:
        """Give control back: whoever uses a control next drives, or the only page there is."""
        people.release(who)
        return control_state(people, who)

    return router


def control_state(people: People, who: Visitor) -> ControlState:
    """For ``who`` asks."""
    driver = people.driver
    return ControlState(
        driver=driver.name if driver else None,
        visitors=people.visitors,
        watching=people.watching,
        you_drive=driver == who,
    )
