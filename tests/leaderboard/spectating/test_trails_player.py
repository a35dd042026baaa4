"""The player of trails in a real browser, on matches that were really played."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.responses import JSONResponse, Response
from tests.browsers import chromium
from tests.leaderboard.spectating.pages_for_tests import trails_page

from wildscav_engine.record import read_record, resimulate
from wildscav_evaluator.matches.snapshots import snapshot_of
from wildscav_leaderboard.spectating.document import Trails
from wildscav_leaderboard.spectating.live import LiveMatches
from wildscav_leaderboard.spectating.overview import overview_of_file
from wildscav_leaderboard.spectating.trails import trails_of_file

pytestmark = pytest.mark.slow

Records = Callable[[str], Path]
HOSTILE = "<img src=x onerror=alert(1)>"
RANGE = "Time of the match"


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as browser:
        yield browser


def answer_with(trails: Trails) -> Callable[[str], Response]:
    return lambda _: Response(trails.model_dump_json(), media_type="application/json")


@pytest.fixture(scope="module")
def address(record_of_track: Records) -> Iterator[str]:
    record = record_of_track("battle")
    with trails_page(answer_with(trails_of_file(record)), overview_of_file(record)) as address:
        yield address


@pytest.fixture
def page(browser: Any) -> Iterator[Any]:
    """A page that may neither fail nor break its policy."""
    with browser.new_context(viewport={"width": 1280, "height": 900}) as context:
        page = context.new_page()
        faults: list[str] = []
        page.on("console", lambda message: faults.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: faults.append(str(error)))
        yield page
        assert faults == []


def open_player(page: Any, address: str) -> None:
    page.goto(address)
    page.get_by_role("button", name="Play").wait_for()


def pixels(page: Any) -> str:
    return str(page.locator(".trails-map").evaluate("canvas => canvas.toDataURL()"))


def test_playing_moves_the_agents_and_pausing_stops_them(page: Any, address: str) -> None:
    open_player(page, address)
    before = pixels(page)

    page.get_by_role("button", name="Play").click()
    page.locator(".trails-time", has_text="0:02 of").wait_for()
    page.get_by_role("button", name="Pause").click()
    paused = pixels(page)
    page.wait_for_timeout(300)

    assert paused != before
    assert pixels(page) == paused


def test_scrubbing_shows_that_moment_and_back_again_the_first(page: Any, address: str) -> None:
    open_player(page, address)
    pixels(page)  # the first reading makes a browser draw in another way, with other smooth edges
    page.get_by_label(RANGE).fill("10")
    before = pixels(page)

    page.get_by_label(RANGE).fill("20")

    assert pixels(page) != before
    assert page.locator(".trails-time").text_content() == "0:20 of 0:30"
    assert page.get_by_label(RANGE).get_attribute("aria-valuetext") == "0:20 of 0:30"
    page.get_by_label(RANGE).fill("10")
    assert pixels(page) == before


def test_everything_can_be_done_with_the_keyboard(page: Any, address: str) -> None:
    open_player(page, address)

    page.get_by_label(RANGE).focus()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    assert page.locator(".trails-time").text_content() == "0:03 of 0:30"
    page.get_by_role("button", name="On 5 seconds").press("Enter")
    assert page.locator(".trails-time").text_content() == "0:08 of 0:30"
    page.get_by_role("button", name="Back 5 seconds").press("Space")
    assert page.locator(".trails-time").text_content() == "0:03 of 0:30"


def test_an_event_leads_to_its_moment(page: Any, address: str, record_of_track: Records) -> None:
    trails = trails_of_file(record_of_track("battle"))
    death = next(event for event in trails.events if event.kind == "death")
    assert death.seat is not None
    open_player(page, address)

    page.locator(".trails-events button", has_text="dies").first.click()

    seconds = death.frame // trails.frames_per_second
    assert page.locator(".trails-time").text_content() == f"0:{seconds:02d} of 0:30"
    assert "dead" in page.locator(".trails-seat").nth(death.seat).text_content()
    page.get_by_label("deaths").uncheck()
    assert page.locator(".trails-events button", has_text="dies").count() == 0


def test_a_seat_is_followed_when_the_map_is_enlarged(page: Any, address: str) -> None:
    open_player(page, address)
    page.get_by_role("button", name="Zoom in").click()
    enlarged = pixels(page)

    page.locator(".trails-seat").nth(1).click()

    assert page.locator(".trails-seat").nth(1).get_attribute("aria-pressed") == "true"
    assert pixels(page) != enlarged


@pytest.mark.parametrize("track", ["navigation", "gathering", "capture", "royale"])
def test_each_track_plays_without_a_picture_of_its_map(
    page: Any, record_of_track: Records, track: str
) -> None:
    with trails_page(answer_with(trails_of_file(record_of_track(track)))) as address:
        open_player(page, address)
        before = pixels(page)
        page.get_by_role("button", name="On 5 seconds").click()

        assert pixels(page) != before


def test_names_of_competitors_are_text(page: Any, record_of_track: Records) -> None:
    trails = trails_of_file(record_of_track("battle"))
    seats = [seat.model_copy(update={"name": HOSTILE}) for seat in trails.seats]
    with trails_page(answer_with(trails.model_copy(update={"seats": seats}))) as address:
        open_player(page, address)

        assert page.locator(".trails-name").first.text_content() == HOSTILE
        assert HOSTILE in page.locator(".trails-events").text_content()
        assert page.locator(".trails img").count() == 0


def test_seats_have_the_names_that_the_page_gives_them(page: Any, record_of_track: Records) -> None:
    told = trails_of_file(record_of_track("battle")).model_dump_json()
    names = '{"0": "The <b>Owls</b>"}'
    with trails_page(lambda _: Response(told, media_type="application/json"), names=names) as address:
        open_player(page, address)
        seats = page.locator(".trails-seat")
        assert seats.first.locator(".trails-name").text_content() == "The <b>Owls</b>"
        assert seats.first.locator(".trails-badge").text_content() == "0"


def test_a_match_that_is_still_rendered_is_waited_for(page: Any, record_of_track: Records) -> None:
    trails = trails_of_file(record_of_track("battle"))
    asked: list[str] = []

    def answer(after: str) -> Response:
        asked.append(after)
        if len(asked) == 1:
            return JSONResponse({"state": "rendering", "detail": "Soon …"}, 202)
        return answer_with(trails)(after)

    with trails_page(answer) as address:
        page.goto(address)
        page.get_by_text("Soon …").wait_for()
        page.get_by_role("button", name="Play").wait_for()

    assert len(asked) == 2


def test_a_map_that_is_still_drawn_is_asked_for_until_it_is_there(
    page: Any, record_of_track: Records
) -> None:
    record = record_of_track("navigation")
    with trails_page(answer_with(trails_of_file(record)), overview_of_file(record), drawn_after=1) as address:
        page.goto(address)
        page.get_by_text("The map is being drawn").wait_for()
        players = page.locator(".trails-map").count()
        page.get_by_role("button", name="Play").wait_for()
        drawn = pixels(page)
    with trails_page(answer_with(trails_of_file(record))) as address:
        open_player(page, address)

        assert players == 0
        assert drawn != pixels(page)  # plain ground


def test_events_are_one_stop_and_the_arrows_lead_through_them(page: Any, address: str) -> None:
    open_player(page, address)
    page.locator(".trails-filters input").last.focus()
    page.keyboard.press("Tab")  # to the list
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    second = page.locator(".trails-events button").nth(1)
    assert second.evaluate("one => one === document.activeElement")
    page.keyboard.press("Enter")
    assert page.locator(".trails-time").text_content().startswith(second.locator(".trails-at").text_content())
    page.keyboard.press("Tab")
    assert page.locator(".trails-events :focus").count() == 0


def test_a_narrow_page_needs_no_sideways_scrolling(browser: Any, address: str) -> None:
    with browser.new_context(viewport={"width": 390, "height": 844}) as context:
        page = context.new_page()
        open_player(page, address)

        assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_nothing_keeps_people_out(browser: Any, address: str) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    with browser.new_context(color_scheme="light", bypass_csp=True) as context:
        page = context.new_page()
        open_player(page, address)
        page.get_by_label(RANGE).fill("10")

        for scheme, rules in (("light", {}), ("dark", {"runOnly": ["color-contrast"]})):
            page.emulate_media(color_scheme=scheme)
            found = axe.run(page, options={"resultTypes": ["violations"], **rules})

            assert found.violations_count == 0, (scheme, found.generate_report())


def test_a_running_match_moves_by_itself_until_its_record_is_there(
    page: Any, tmp_path: Path, record_of_track: Records
) -> None:
    path = record_of_track("battle")
    record, told = read_record(path), trails_of_file(path)
    moments = [snapshot_of(match) for match in resimulate(record)]
    live = LiveMatches(tmp_path)
    live.add("m1", record.spec, record.names, moments[:60])

    def answer(after: str) -> Response:
        trails = live.trails("m1", after) or told
        return Response(trails.model_dump_json(), media_type="application/json")

    with trails_page(answer, is_live=True) as address:
        open_player(page, address)
        page.locator(".trails-time", has_text="0:05 of 0:05").wait_for()
        before = pixels(page)
        live.add("m1", record.spec, record.names, moments[60:210])
        page.locator(".trails-time", has_text="0:20 of 0:20").wait_for()
        moved = pixels(page)
        page.get_by_role("button", name="Back 5 seconds").click()  # whoever looks back is left alone
        live.add("m1", record.spec, record.names, moments[210:260])
        page.locator(".trails-time", has_text="of 0:25").wait_for()
        looking_back = page.locator(".trails-time").text_content()
        page.get_by_role("button", name="present moment").click()
        page.locator(".trails-time", has_text="0:25 of 0:25").wait_for()
        live.end("m1")
        page.get_by_text("The match is over.").wait_for()
        events = page.locator(".trails-events li").count()

    assert moved != before
    assert looking_back == "0:15 of 0:25"
    assert events == len(told.events)


def test_a_lost_connection_is_said_and_mended(page: Any, tmp_path: Path, record_of_track: Records) -> None:
    record = read_record(record_of_track("battle"))
    moments = [snapshot_of(match) for match in resimulate(record)]
    live = LiveMatches(tmp_path)
    live.add("m1", record.spec, record.names, moments[:30])
    asked: list[str] = []

    def answer(after: str) -> Response:
        asked.append(after)
        if len(asked) == 2:
            return Response("not now", media_type="application/json")
        trails = live.trails("m1", after)
        assert trails is not None
        return Response(trails.model_dump_json(), media_type="application/json")

    with trails_page(answer, is_live=True) as address:
        open_player(page, address)
        page.get_by_text("The connection is lost").wait_for()
        live.add("m1", record.spec, record.names, moments[30:60])
        page.locator(".trails-time", has_text="0:05 of 0:05").wait_for()
        said = page.locator(".trails-status").text_content()
        page.goto("about:blank")  # so that it asks no more when the server is gone

    assert "The connection is lost" not in said
