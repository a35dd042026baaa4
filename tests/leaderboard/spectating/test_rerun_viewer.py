"""The Rerun viewer as a season's server serves it, and a replay in it in a real browser."""

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from html import escape
from io import BytesIO
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse, Response
from PIL import Image
from tests.browsers import IN_3D, chromium
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.api.matches import file_response
from wildscav_leaderboard.spectating.render_cache import RenderCache
from wildscav_leaderboard.spectating.rerun_viewer import PATH, VERSION, address_of, router

pytestmark = pytest.mark.slow
PATIENCE = 300.0  # s, on a busy machine without a graphics card
FEWEST_COLORS = 500  # in the picture of a match; the page alone has some ten
FRAME = (
    '<!doctype html><html lang="en"><title>Replay</title><style>iframe{{width:100%;height:95vh}}</style>'
    '<iframe title="The replay" src="{}"></iframe></html>'
)


@pytest.fixture(scope="module")
def viewer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the compressed files: to compress them takes seconds."""
    return tmp_path_factory.mktemp("viewer")


@pytest.fixture(scope="module")
def client(viewer: Path) -> Iterator[httpx.Client]:
    with serving_viewer(viewer) as client:
        yield client


@contextmanager
def serving_viewer(folder: Path) -> Iterator[httpx.Client]:
    app = FastAPI()
    app.include_router(router(folder))
    with served(app) as address, httpx.Client(base_url=address, timeout=120.0) as client:
        yield client


def test_the_page_names_its_script_and_both_are_there(client: httpx.Client) -> None:
    assert b"re_viewer.js" in client.get(PATH).content
    assert b"wasm_bindgen" in client.get(f"{PATH}re_viewer.js").content


def test_the_program_comes_compressed_with_its_type(client: httpx.Client) -> None:
    answer = client.get(f"{PATH}re_viewer_bg.wasm", headers={"Accept-Encoding": "gzip"})

    assert answer.headers["Content-Type"] == "application/wasm"
    assert answer.headers["Content-Encoding"] == "gzip"
    assert int(answer.headers["Content-Length"]) < len(answer.content) / 2
    assert answer.content.startswith(b"\x00asm")
    assert "immutable" in answer.headers["Cache-Control"]


def test_who_takes_nothing_compressed_gets_the_same(client: httpx.Client) -> None:
    plain = client.get(f"{PATH}index.html", headers={"Accept-Encoding": "identity"})

    assert "Content-Encoding" not in plain.headers
    assert plain.content == client.get(PATH).content


def test_the_viewer_may_ask_this_host_alone(client: httpx.Client) -> None:
    policy = client.get(PATH).headers["Content-Security-Policy"]

    assert "connect-src 'self';" in policy
    assert "frame-ancestors 'self'" in policy
    assert re.search(r"https?:", policy) is None


@pytest.mark.parametrize(
    "path", ["/viewer/0.0.1/", f"{PATH}none.js", f"{PATH}../../etc/passwd", f"{PATH}.lock"]
)
def test_there_is_nothing_else(client: httpx.Client, path: str) -> None:
    assert client.get(path).status_code == 404


def test_the_files_are_kept_for_the_next_server(viewer: Path, client: httpx.Client) -> None:
    assert client.get(PATH).status_code == 200
    made = (viewer / VERSION).stat().st_mtime_ns
    with serving_viewer(viewer) as other:
        assert other.get(PATH).status_code == 200
    assert (viewer / VERSION).stat().st_mtime_ns == made
    assert [path.name for path in viewer.iterdir() if path.name.endswith(".part")] == []


def test_the_address_carries_the_recording() -> None:
    address = address_of("https://season.example/matches/7/replay.rrd?a=b&c=d")

    assert urlsplit(address).path == PATH
    assert parse_qs(urlsplit(address).query)["url"] == ["https://season.example/matches/7/replay.rrd?a=b&c=d"]


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


@pytest.mark.long
def test_a_browser_shows_the_match_and_asks_nobody_else(
    tmp_path: Path, viewer: Path, record_of_track: Callable[[str], Path]
) -> None:
    end = time.monotonic() + PATIENCE
    record = record_of_track("battle")
    with RenderCache(tmp_path / "rendered") as cache:
        while cache.progress("replay", "m1", record, datetime.now(UTC)).state != "ready":
            assert time.monotonic() < end
            time.sleep(0.2)
        app = application(cache, record, viewer)
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
