"""The page that waits for a replay, in a real browser: it asks until it gets an answer that stays."""

import pytest
from fastapi import FastAPI
from fastapi.responses import HTMLResponse, JSONResponse, Response
from fastapi.staticfiles import StaticFiles
from tests.browsers import chromium
from tests.leaderboard.spectating.pages_for_tests import STATIC
from tests.leaderboard.spectating.served import served

PAGE = """<!doctype html><title>Replay</title><p id="replay-status"></p>
<iframe data-viewer="/viewer" data-progress="/replay"></iframe>
<script type="module" src="/static/watch.js"></script>"""
HIDDEN = {"error": "the season is frozen", "status": 403}


@pytest.mark.slow
def test_a_refusal_is_shown_and_not_asked_for_again() -> None:
    app, asked = FastAPI(), []
    app.mount("/static", StaticFiles(directory=STATIC))

    @app.get("/")
    def page() -> HTMLResponse:
        return HTMLResponse(PAGE)

    @app.get("/replay")
    def replay() -> Response:
        asked.append(1)
        is_first = len(asked) == 1
        return JSONResponse({"state": "waiting"} if is_first else HIDDEN, 202 if is_first else 403)

    with served(app) as address, chromium() as browser:
        shown = browser.new_page()
        shown.goto(address)
        shown.wait_for_function("document.querySelector('#replay-status').textContent.includes('frozen')")
        shown.wait_for_timeout(2500)
    assert len(asked) == 2
