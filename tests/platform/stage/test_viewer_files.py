"""The viewer's files as sites serve them."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from starlette.applications import Starlette
from starlette.routing import Mount
from tests.leaderboard.spectating.served import served
from tests.platform.stage.built_viewer import SCRIPT

from wildscav_stage.viewer_files import PATH, viewer_addresses, viewer_routes


@pytest.fixture
def client(viewer: Path) -> Iterator[httpx.Client]:
    site = Starlette(routes=[Mount(PATH, viewer_routes())])
    with served(site) as address, httpx.Client(base_url=address, timeout=60.0) as client:
        yield client


def test_the_address_on_pages_is_kept_for_ever_and_another_is_not(client: httpx.Client, viewer: Path) -> None:
    script, style = viewer_addresses()
    for address in (script, style):
        answer = client.get(address)
        assert answer.headers["Cache-Control"] == "public, max-age=31536000, immutable"
    assert client.get(script).headers["Content-Type"] == "text/javascript; charset=utf-8"
    assert client.get(f"{PATH}/viewer.js").headers["Cache-Control"] == "no-cache"

    (viewer / "viewer.js").write_text("changed")

    assert viewer_addresses()[0] != script
    assert viewer_addresses()[1] == style
    assert client.get(script).text == "changed"
    assert client.get(script).headers["Cache-Control"] == "no-cache"


def test_they_are_compressed_for_those_who_take_that(client: httpx.Client) -> None:
    for accepted, coding in (("gzip", "gzip"), ("identity", None)):
        answer = client.get(f"{PATH}/viewer.js", headers={"Accept-Encoding": accepted})
        assert answer.headers.get("Content-Encoding") == coding
        assert answer.text == SCRIPT


@pytest.mark.parametrize("name", ["other.js", "..", "%2e%2e", "%2e%2e%2fplay.css", "", "a" * 300])
def test_nothing_else_is_served(client: httpx.Client, name: str) -> None:
    assert client.get(f"{PATH}/{name}").status_code == 404
