"""Whether the server and its simulation are alive."""

from fastapi import APIRouter
from pydantic import BaseModel

from app.proxy import Relay
from app.session import Session
from app.state import Status


class Health(BaseModel):
    """Answer of /health."""

    server: str
    simulation: Status
    viewers: int
    """Connected browsers."""
    most_viewers: int
    """More are turned away."""


def health_router(session: Session, relay: Relay) -> APIRouter:
    """GET /health."""
    router = APIRouter(tags=["health"])

    @router.get("/health")
    def health() -> Health:
        """Whether anything is wrong."""
        simulation = session.state.status
        return Health(server="ok", simulation=simulation, viewers=relay.clients, most_viewers=relay.max_clients)

    return router
