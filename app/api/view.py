"""What everybody who watches is shown: asked and changed."""

from typing import Annotated

from fastapi import APIRouter, Body, Depends

from app.api.control import Asker
from app.api.examples import VIEWS
from app.people import Visitor
from app.session import Session
from app.view import SharedView


def view_router(session: Session) -> APIRouter:
    """GET and PATCH /session/view."""
    router = APIRouter(tags=["session"])
    asks = Asker(session.people)

    @router.get("/session/view")
    def view() -> SharedView:
        """What every page shows alike, and whether the next trial begins by itself."""
        return session.state.view

    @router.patch("/session/view")
    def change(
        given: Annotated[SharedView, Body(openapi_examples=VIEWS)], who: Annotated[Visitor, Depends(asks)]
    ) -> SharedView:
        """Change what is given; the rest stays, and the answer is the whole. 409 says that somebody else drives."""
        session.people.admit(who)
        return session.change_view(lambda view: view.changed(given))

    return router
