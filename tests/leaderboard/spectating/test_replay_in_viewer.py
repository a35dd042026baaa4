"""A replay in the Rerun viewer, in a frame of a page, in a real browser: from the record to the picture."""

import time
from collections.abc import Callable
from datetime import UTC, datetime
from html import escape
from io import BytesIO
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse, Response
from PIL import Image
from tests.browsers import IN_3D, chromium
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.api.matches import file_response
from wildscav_leaderboard.spectating.render_cache import RenderCache
from wildscav_leaderboard.spectating.rerun_viewer import address_of, router

pytestmark = [pytest.mark.slow, pytest.mark.long]
PATIENCE = 300.0  # s, on a busy machine without a graphics card
FEWEST_COLORS = 500  # in the picture of a match; the page alone has some ten
FRAME = (
    '<!doctype html><html lang="en"><title>Replay</title><style>iframe{{width:100%;height:95vh}}</style>'
    '<iframe title="The replay" src="{}"></iframe></html>'
)


def application(cache: RenderCache, record: Path, viewer: Path) -> FastAPI:
    """A match page that shows its replay."""
    app = FastAPI()
    app.include_router(router(viewer))

    @app.get("/")
    def page(request: Request) -> HTMLResponse:
        return HTMLResponse(FRAME.format(escape(address_of(f"{request.base_url}replay.rrd"))))

    @app.get("/replay.rrd")
    def replay() -> Response:
        return file_response("replay", cache.progress("replay", "m1", record, datetime.now(UTC)))

    return app


def colors_of(picture: bytes) -> int:
    image = Image.open(BytesIO(picture)).convert("RGB")
    return len(image.getcolors(maxcolors=image.width * image.height) or [])


def test_a_browser_shows_the_match_and_asks_nobody_else(
    tmp_path: Path, record_of_track: Callable[[str], Path]
) -> None:
    end = time.monotonic() + PATIENCE
    record = record_of_track("battle")
    with RenderCache(tmp_path / "rendered") as cache:
        while cache.progress("replay", "m1", record, datetime.now(UTC)).state != "ready":
            assert time.monotonic() < end
            time.sleep(0.2)
        app = application(cache, record, tmp_path / "viewer")
        with served(app) as address, chromium(*IN_3D) as browser:
            page = browser.new_page(viewport={"width": 640, "height": 400})  # every pixel costs the processor
            answered: dict[str, int] = {}
            page.on("response", lambda answer: answered.update({answer.url: answer.status}))
            page.goto(address)
            while colors_of(page.screenshot()) < FEWEST_COLORS and time.monotonic() < end:
                time.sleep(1.0)

            assert colors_of(page.screenshot()) >= FEWEST_COLORS
            assert page.frames[1].evaluate("() => window._handle.has_panicked()") is False
            assert answered[f"{address}/replay.rrd"] in (200, 206)
            hosts = {urlsplit(url).netloc for url in answered if url.startswith("http")}
            assert hosts == {urlsplit(address).netloc}
            page.screenshot(path=tmp_path / "replay.png")
