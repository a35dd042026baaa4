"""Battles in real browsers: two people fight each other, one plays by touch, one loses the connection."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.platform.stage.playing.browsers import PATIENCE, browser, pages, start, wait_for_match
from tests.platform.stage.playing.tables import MEADOW, small_plan, table_in_thread

from wildscav_engine.record import Record, read_record, verify_record
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_stage.playing.plan import Plan

TURNING = 110.0  # degrees per second, with the arrow keys, as in controls.ts
WIDE = {"viewport": {"width": 480, "height": 300}}  # small, as software draws
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}

__all__ = ["browser"]

pytestmark = pytest.mark.slow


def face_to_face(people: int = 1, opponents: tuple[str, ...] = (), seconds: float = 7.0) -> Plan:
    """A battle of two who start a few metres apart, the second north of the first."""
    plan = small_plan("battle", seconds, opponents, people)
    starts = ((0.0, 0.0, -4.0), (0.0, 0.0, 4.0))
    lawn = MapSpec(config=MEADOW.model_copy(update={"houses": 0}), seed=5)
    return replace(plan, spec=plan.spec.model_copy(update={"starts": starts, "map": lawn}))


def turn_to(page: Any, bearing: float, within: float = 4.0) -> None:
    """Turn by the arrow keys until the compass shows a direction."""
    for _ in range(40):
        away = (bearing - float(page.get_attribute("#compass", "data-yaw")) + 180.0) % 360.0 - 180.0
        if abs(away) <= within:
            return
        press(page, away)


def press(page: Any, degrees: float) -> None:
    """Turn right by about some degrees with an arrow key."""
    key = "ArrowRight" if degrees > 0 else "ArrowLeft"
    page.keyboard.down(key)
    time.sleep(0.8 * abs(degrees) / TURNING)
    page.keyboard.up(key)
    time.sleep(0.15)


def recorded(page: Any) -> Record:
    """Wait for the end, and return the record that the host's page names."""
    page.wait_for_selector("#game[data-state=over]", timeout=PATIENCE * 1000)
    record = read_record(Path(page.inner_text("#record code")))
    assert verify_record(record).holds
    return record


def test_two_browsers_fight_each_other_while_a_third_watches(tmp_path: Path, browser: Any) -> None:
    with table_in_thread(face_to_face(people=2, seconds=20.0), tmp_path) as links, pages(browser) as new_page:
        host, guest, spectator = (new_page(**WIDE) for _ in range(3))
        spectator.goto(links.watch)
        guest.goto(links.guests[0])
        guest.fill("#lobby input", "Ada")
        guest.press("#lobby input", "Enter")
        host.goto(links.host)
        host.wait_for_selector("#lobby li:nth-child(2)[data-where=here] >> text=Ada")
        host.click("#go")
        wait_for_match(guest)
        wait_for_match(host)
        turn_to(host, 0.0)
        turn_to(guest, 180.0)
        host.keyboard.down("KeyF")
        guest.keyboard.down("KeyF")
        spectator.wait_for_selector("#views button >> text=Ada")
        spectator.keyboard.press("2")
        spectator.wait_for_selector("#game[data-view=eyes][data-seat='1']")
        record = recorded(host)
        for page in (guest, spectator):
            page.wait_for_selector("#game[data-state=over]")
        assert guest.inner_text("#result").count("Ada") == 0  # one's own line says "you"
        assert "Ada" in spectator.inner_text("#result")
        assert guest.is_hidden("#record")
        assert host.inner_text("#go") == "Play again"
    assert record.names == ("person 1", "Ada")
    assert all(seat.shots > 0 for seat in record.result.seats)
    assert sum(seat.hits for seat in record.result.seats) > 0


def test_a_guest_joins_by_the_code_and_one_who_comes_late_watches_first(tmp_path: Path, browser: Any) -> None:
    plan = small_plan("navigation", 20.0, people=3)
    with table_in_thread(plan, tmp_path) as links, pages(browser) as new_page:
        host, guest, late = (new_page(**each) for each in (WIDE, PHONE, WIDE))
        host.goto(links.host)
        code = host.inner_text("#room b")
        guest.goto(links.host.partition("play/")[0])
        guest.fill("#code", code.lower())
        guest.tap("#entry button")
        guest.wait_for_selector("#game[data-state=lobby]")
        guest.tap("#go")
        host.wait_for_selector("#lobby li:nth-child(3) >> text=ready")
        host.select_option("#next select >> nth=0", "1")
        guest.wait_for_selector("#next >> text=Also in the match: ")
        host.click("#go")
        wait_for_match(host)
        late.goto(links.entrance)
        late.click("#entry button")
        late.wait_for_selector("#game[data-state=elsewhere]")
        late.click("#go")
        late.wait_for_selector("#game[data-state=watching]", timeout=PATIENCE * 1000)
        recorded(host)
        late.wait_for_url("**/play/**")
        for page in (guest, late):
            page.wait_for_selector("#game[data-state=over]")
            assert page.inner_text("#replay a >> nth=0") == "Watch it in 3D"
            assert page.is_hidden("#record")
        assert late.inner_text("#title") == "The match is over"
        late.goto(late.locator("#replay a").first.evaluate("link => link.href"))
        late.wait_for_selector(".player-icon", state="attached", timeout=PATIENCE * 1000)


class Fingers:
    """Fingers on a phone's screen."""

    def __init__(self, page: Any) -> None:
        self._session = page.context.new_cdp_session(page)
        self._page = page

    def at(self, selector: str, right: float = 0.0, down: float = 0.0) -> dict[str, float]:
        """Return a point of an element: its centre, or as far from there as half of its size."""
        box = self._page.locator(selector).bounding_box()
        x, y = box["x"] + box["width"] / 2 * (1 + right), box["y"] + box["height"] / 2 * (1 + down)
        return {"x": x, "y": y}

    def touch(self, kind: str, *points: dict[str, float]) -> None:
        """Send an event of the touch screen with all fingers that are on it."""
        fingers = [point | {"id": number} for number, point in enumerate(points)]
        self._session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": fingers})


def test_a_phone_moves_looks_and_shoots_by_touch(tmp_path: Path, browser: Any) -> None:
    plan = face_to_face(opponents=("walker-easy",), seconds=8.0)
    with table_in_thread(plan, tmp_path) as links, pages(browser) as new_page:
        page = new_page(**PHONE)
        start(page, links.host)
        assert page.is_visible("#stick")
        fingers = Fingers(page)
        fingers.touch("touchStart", fingers.at("#picture"))
        fingers.touch("touchMove", fingers.at("#picture", right=0.5))
        fingers.touch("touchEnd")
        stick, shoot = fingers.at("#stick"), fingers.at("#buttons [data-flag=shoot]")
        fingers.touch("touchStart", stick)
        fingers.touch("touchMove", fingers.at("#stick", down=-0.8))
        fingers.touch("touchStart", fingers.at("#stick", down=-0.8), shoot)  # both at once
        time.sleep(1.0)
        fingers.touch("touchEnd")
        record = recorded(page)
    own = record.result.seats[0]
    assert own.walked > 3.0  # m
    assert own.shots > 0
    assert record.actions[:, 0, 2].sum() == pytest.approx(390 / 4 * 0.3, abs=1.0)  # degrees to the right


def test_a_browser_comes_back_to_its_seat_when_its_connection_or_another_page_has_taken_it(
    tmp_path: Path, browser: Any
) -> None:
    sockets: list[Any] = []

    # The server closes no page of this test: a routed one might still send, which Chromium calls an error.
    def pass_on(socket: Any) -> None:
        socket.connect_to_server()
        sockets.append(socket)

    with table_in_thread(face_to_face(people=2, seconds=60.0), tmp_path) as links, pages(browser) as new_page:
        host, guest, other = (new_page(**WIDE) for _ in range(3))
        guest.route_web_socket("**/socket", pass_on)
        guest.goto(links.guests[0])
        host.goto(links.host)
        host.wait_for_selector("#lobby li:nth-child(2)[data-where=here]")
        host.click("#go")
        wait_for_match(guest)
        sockets[0].close(code=3000, reason="as if the network were lost")
        guest.wait_for_selector("#game[data-state=lost]")
        wait_for_match(guest)
        assert len(sockets) == 2
        other.goto(links.guests[0])
        wait_for_match(other)
        guest.wait_for_selector("#game[data-state=closed] >> text=Opened elsewhere")
        guest.click("#go")
        wait_for_match(guest)
        other.wait_for_selector("#game[data-state=closed] >> text=Opened elsewhere")
