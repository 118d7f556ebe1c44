"""Whether the server and its simulation are alive."""

from fastapi import APIRouter
from pydantic import BaseModel

from app.session import Session
from app.state import Status


class Health(BaseModel):
    """Answer of /health."""

    server: str
    simulation: Status


def health_router(session: Session) -> APIRouter:
    """GET /health."""
    router = APIRouter(tags=["health"])

    @router.get("/health")
    def health() -> Health:
        return Health(server="ok", simulation=session.state.status)

    return router
