"""The viewer in a real browser, on matches that were really played: on a site, and as a file."""

import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from io import BytesIO
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.browsers import CHROMIUM, DESK, IN_3D, PHONE, chromium
from tests.leaderboard.spectating.served import served

from wildscav_engine.record import read_record
from wildscav_stage.scene.trails import trails_of
from wildscav_stage.watching.match_page import scene_of, whole_page
from wildscav_stage.watching.match_site import match_site

pytestmark = pytest.mark.slow

Records = Callable[[str], Path]
PATIENCE = 60_000  # ms, with software that draws
TIME = "Time of the match"
CHANGED = 0.5  # of 255, on average, if something moved
SIMILAR = 10  # of 255, on average, of one moment drawn more finely or less
BLOCKED = "--disable-3d-apis"
# Takes the graphics processor away, and gives it back a second later.
LOSE = """() => new Promise((resolve) => {
  const canvas = document.querySelector(".player-canvas");
  const context = canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
  canvas.addEventListener("webglcontextrestored", resolve);
  context.loseContext();
  setTimeout(() => context.restoreContext(), 1000);
})"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium(*IN_3D) as browser:
        yield browser


@pytest.fixture(scope="module")
def site(record_of_track: Records) -> Iterator[str]:
    with served(match_site("", [record_of_track("battle")])) as address:
        yield address


@contextmanager
def opened(browser: Any, address: str, allowed: str | None = None, **options: Any) -> Iterator[Any]:
    """A page with a match, which may neither fail nor break its policy; it may report what is allowed."""
    with browser.new_context(**{"viewport": DESK, "reduced_motion": "reduce", **options}) as context:
        page = context.new_page()
        faults: list[str] = []
        page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(address)
        page.locator(".player-canvas").first.wait_for(timeout=PATIENCE)
        page.locator(".player-screen > .player-message:empty").first.wait_for(
            state="attached", timeout=PATIENCE
        )
        yield page
        assert [fault for fault in faults if allowed is None or allowed not in fault] == []


def wait_for(page: Any, time: str) -> None:
    """Wait until a page says that this is the moment it shows."""
    page.locator(".player-time", has_text=re.compile(f"^{time}")).wait_for(timeout=PATIENCE)


def picture_of(page: Any, number: int = 0) -> bytes:
    """Return what a canvas shows, once it stands still."""
    last = b""
    for _ in range(40):
        page.wait_for_timeout(250)
        now = bytes(page.locator(".player-canvas").nth(number).screenshot())
        if now == last:
            return now
        last = now
    return last


def told_by(page: Any) -> tuple[str, list[str]]:
    """Return what a page says of its moment and its view, however finely it draws them."""
    standings = page.locator(".player-seats").inner_text()
    return standings, page.locator("[aria-pressed=true]").all_inner_texts()


def difference(one: bytes, other: bytes) -> float:
    """Return how far two pictures are apart, of 255; where pictures are slow, they are drawn less finely."""
    small = [
        np.asarray(Image.open(BytesIO(each)).convert("RGB").resize((160, 90)), float) for each in (one, other)
    ]
    return float(np.abs(small[0] - small[1]).mean())


def test_it_plays_and_a_link_leads_to_a_moment_and_a_view(browser: Any, site: str) -> None:
    with opened(browser, f"{site}#t=10&view=behind&seat=1") as page:
        wait_for(page, "0:10 of 0:30")
        first, told = picture_of(page), told_by(page)
        page.get_by_role("button", name="Play", exact=True).click()
        wait_for(page, "0:12 of")
        page.get_by_role("button", name="Pause").click()
        assert difference(picture_of(page), first) > CHANGED
        page.get_by_role("button", name="Free", exact=True).click()
        assert told_by(page) != told
        page.evaluate("location.hash = '#view=behind&seat=1&t=10'")
        wait_for(page, "0:10 of 0:30")
        assert told_by(page) == told


def test_a_graphics_processor_that_comes_back_draws_on(browser: Any, site: str) -> None:
    with opened(browser, f"{site}#t=10&view=behind&seat=1") as page:
        first = picture_of(page)
        page.evaluate(LOSE)
        assert any(difference(picture_of(page), first) < SIMILAR for _ in range(40))
        assert page.locator(".player-canvas").get_attribute("aria-label") == "The match in 3D"


def test_a_page_without_an_address_says_so(browser: Any, tmp_path: Path, record_of_track: Records) -> None:
    inner = escape(whole_page(scene_of(record_of_track("battle"))))
    file = tmp_path / "outer.html"
    file.write_text(f'<iframe sandbox="allow-scripts" width="1200" height="900" srcdoc="{inner}"></iframe>')
    with browser.new_context(viewport=DESK, reduced_motion="reduce") as context:
        page = context.new_page()
        page.goto(file.as_uri())
        inside = page.frame_locator("iframe")
        inside.locator(".player-canvas").wait_for(timeout=PATIENCE)
        inside.get_by_role("button", name="Copy a link").click()
        inside.get_by_text("has no link of its own").wait_for()


def test_each_view_shows_something_else(browser: Any, site: str) -> None:
    with opened(browser, f"{site}#t=5&view=above") as page:
        shown = [picture_of(page)]
        for view in ("Behind", "Eyes", "Free"):
            page.get_by_role("button", name=view, exact=True).click()
            shown.append(picture_of(page))
        page.locator(".player-seat").nth(2).click()
        shown.append(picture_of(page))

        assert min(difference(*pair) for pair in combinations(shown, 2)) > 3


def test_keys_events_and_the_slider_lead_through_the_match(
    browser: Any, site: str, record_of_track: Records
) -> None:
    trails = trails_of(read_record(record_of_track("battle")))
    death = next(event for event in trails.events if event.kind == "death")
    with opened(browser, f"{site}#t=3") as page:
        page.keyboard.press("ArrowRight")
        wait_for(page, "0:08 of 0:30")
        page.keyboard.press("ArrowLeft")
        wait_for(page, "0:03 of 0:30")
        page.get_by_label(TIME).fill("20")
        assert page.get_by_label(TIME).get_attribute("aria-valuetext") == "0:20 of 0:30"
        page.locator(".player-events button", has_text="dies").first.click()
        wait_for(page, f"0:{death.frame // trails.frames_per_second:02d} of 0:30")
        assert page.locator(".player-seat.player-dead").count() >= 1


@pytest.mark.parametrize("track", ["navigation", "gathering", "capture", "royale"])
def test_each_track_plays_on_a_phone_without_sideways_scrolling(
    browser: Any, record_of_track: Records, track: str
) -> None:
    with (
        served(match_site("", [record_of_track(track)])) as address,
        opened(browser, f"{address}#t=0", viewport=PHONE, has_touch=True) as page,
    ):
        first = bytes(page.locator(".player-canvas[data-picture=whole]").screenshot(timeout=PATIENCE))
        page.get_by_role("button", name="On 5 seconds").click()

        assert difference(picture_of(page), first) > CHANGED
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]


@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_two_matches_have_one_time_and_one_view(
    browser: Any, record_of_track: Records, size: dict[str, int]
) -> None:
    records = [record_of_track("royale"), record_of_track("battle")]  # of 15 s and of 30 s
    with (
        served(match_site("", records)) as address,
        opened(browser, f"{address}/matches/0?with=1#t=5&view=behind&seat=1", viewport=size) as page,
    ):
        page.locator(".player-canvas[data-picture=whole]").nth(1).wait_for(timeout=PATIENCE)
        canvases = page.locator(".player-canvas")
        before = [bytes(canvases.nth(number).screenshot()) for number in (0, 1)]
        page.get_by_role("button", name="On 5 seconds").click()
        wait_for(page, "0:10 of 0:30")
        after = [bytes(canvases.nth(number).screenshot()) for number in (0, 1)]
        assert min(difference(*pair) for pair in zip(before, after, strict=True)) > CHANGED

        page.get_by_role("button", name="Above", exact=True).click()
        page.get_by_label(TIME).fill("29")
        page.locator(".player-outcome:not(:empty)").wait_for(timeout=PATIENCE)  # of the shorter match alone
        one, other = (canvases.nth(number).bounding_box() for number in (0, 1))
        assert (one["y"] == other["y"]) is (size is DESK)
        assert page.locator(".player-line").count() == 1
        assert page.locator(".player-seats").count() == 2
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]


@pytest.mark.parametrize("view", ["Free", "Above"])
def test_a_person_moves_the_cameras_of_two_matches_at_once(
    browser: Any, record_of_track: Records, view: str
) -> None:
    records = [record_of_track("royale"), record_of_track("battle")]
    with (
        served(match_site("", records)) as address,
        opened(browser, f"{address}/matches/0?with=1#t=5") as page,
    ):
        page.locator(".player-canvas[data-picture=whole]").nth(1).wait_for(timeout=PATIENCE)
        page.get_by_role("button", name=view, exact=True).click()
        for moved, other in ((0, 1), (1, 0)):
            before = picture_of(page, other)
            box = page.locator(".player-canvas").nth(moved).bounding_box()
            page.mouse.move(box["x"] + 200, box["y"] + 150)
            page.mouse.wheel(0, -600)
            page.mouse.down()
            page.mouse.move(box["x"] + 320, box["y"] + 180)
            page.mouse.up()
            assert difference(picture_of(page, other), before) > CHANGED


def test_without_webgl_the_match_is_shown_from_above(browser: Any, site: str) -> None:
    program = shutil.which("chromium")
    with (
        browser.browser_type.launch(executable_path=program, args=[*CHROMIUM, BLOCKED]) as other,
        opened(other, f"{site}#t=5", "WebGL") as page,
    ):
        assert "from above" in str(page.locator(".player-note").text_content())
        first = picture_of(page)
        page.get_by_role("button", name="On 5 seconds").click()
        assert difference(picture_of(page), first) > CHANGED


def test_a_file_plays_without_a_server(browser: Any, tmp_path: Path, record_of_track: Records) -> None:
    file = tmp_path / "match.html"
    file.write_text(whole_page(scene_of(record_of_track("battle"))))
    assert file.stat().st_size < 5_000_000
    asked: list[str] = []
    with opened(browser, f"{file.as_uri()}#t=10") as page:
        page.on("request", lambda request: asked.append(request.url))
        first = picture_of(page)
        page.get_by_role("button", name="On 5 seconds").click()
        assert difference(picture_of(page), first) > CHANGED
        wait_for(page, "0:15 of 0:30")
    assert asked == []


@pytest.mark.parametrize("query", ["", "?with=1"], ids=["one match", "two"])
def test_nothing_keeps_people_out(browser: Any, record_of_track: Records, query: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    records = [record_of_track("battle"), record_of_track("royale")]
    with (
        served(match_site("", records)) as address,
        opened(browser, f"{address}/matches/0{query}#t=10", color_scheme="light", bypass_csp=True) as page,
    ):
        for scheme, rules in (("light", {}), ("dark", {"runOnly": ["color-contrast"]})):
            page.emulate_media(color_scheme=scheme)
            found = axe.run(page, options={"resultTypes": ["violations"], **rules})
            assert found.violations_count == 0, (scheme, found.generate_report())
