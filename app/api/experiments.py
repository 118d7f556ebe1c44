"""The experiments page, and Plotly's script for it from the installed package."""

from __future__ import annotations

from pathlib import Path

import plotly
from fastapi import APIRouter
from fastapi.responses import FileResponse

ASSETS = Path(__file__).resolve().parents[2] / "frontend_assets"
PLOTLY = Path(plotly.__file__).parent / "package_data" / "plotly.min.js"


def experiments_router() -> APIRouter:
    """GET /experiments, and what it loads besides /assets."""
    router = APIRouter()

    @router.get("/experiments", include_in_schema=False)
    def page() -> FileResponse:
        return FileResponse(ASSETS / "experiments.html", media_type="text/html")

    @router.get("/experiments/plotly.js", include_in_schema=False)
    def script() -> FileResponse:
        headers = {"Cache-Control": "max-age=86400"}
        return FileResponse(PLOTLY, media_type="text/javascript", headers=headers)

    return router
