"""The page that describes the API: made from its OpenAPI description, needing nothing from elsewhere."""

from __future__ import annotations

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse


def docs_router(assets: Path) -> APIRouter:
    """GET /api/docs."""
    router = APIRouter()

    @router.get("/api/docs", include_in_schema=False)
    def docs() -> FileResponse:
        return FileResponse(assets / "docs.html")

    return router
