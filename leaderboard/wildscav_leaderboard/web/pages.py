"""All pages of the web site."""

from fastapi import FastAPI
from starlette.staticfiles import StaticFiles

from wildscav_leaderboard.web import boards, feeds, organizing, people, playing, public, submitting, watching
from wildscav_leaderboard.web.rendering import FOLDER, PageParts


def add_pages(app: FastAPI) -> None:
    """Add the pages to an application."""
    for part in (public, boards, watching, playing, feeds, people, submitting, organizing):
        app.include_router(part.router, include_in_schema=False)
    app.state.page_parts = PageParts()
    app.mount("/static", StaticFiles(directory=FOLDER / "static"), name="static")
