"""The experiments page, and Plotly's script for it from the installed package."""

from __future__ import annotations

from importlib.metadata import distribution
from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse

ASSETS = Path(__file__).resolve().parents[2] / "frontend_assets"


def experiments_router() -> APIRouter:
    """GET /experiments, and what it loads besides /assets."""
    router = APIRouter()
    plotly = distribution("plotly").locate_file("plotly/package_data/plotly.min.js")

    @router.get("/experiments", include_in_schema=False)
    def page() -> FileResponse:
        return FileResponse(ASSETS / "experiments.html", media_type="text/html")

    @router.get("/experiments/plotly.js", include_in_schema=False)
    def script() -> FileResponse:
        headers = {"Cache-Control": "max-age=86400"}
        return FileResponse(str(plotly), media_type="text/javascript", headers=headers)

    return router
