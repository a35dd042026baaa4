"""Battles in real browsers: two people fight each other, one fights a robot, one plays by touch."""

import io
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
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


def robots_place(page: Any) -> float | None:
    """Return where the picture shows the second seat's magenta torso, -1 (left) to 1; None if nowhere."""
    pixels = np.asarray(
        Image.open(io.BytesIO(page.locator("#picture").screenshot())).convert("RGB"), np.int16
    )
    red, green, blue = np.moveaxis(pixels[pixels.shape[0] // 4 :], -1, 0)
    columns = np.nonzero((red > green + 80) & (blue > green + 50) & (red > blue + 10))[1]
    return None if len(columns) < 12 else float(np.median(columns)) / pixels.shape[1] * 2 - 1


def duel(folder: Path, browser: Any) -> list[Any]:
    """Fight the robot that stands ahead, and return the results of the person and of the robot."""
    plan = face_to_face(opponents=("fighter-easy",), seconds=15.0)
    with table_in_thread(plan, folder) as links, pages(browser) as new_page:
        page = new_page(**WIDE)
        start(page, links.host)
        page.mouse.down()
        turn_to(page, 0.0)
        while page.get_attribute("#game", "data-state") == "playing":
            place = robots_place(page)
            if place is None:
                time.sleep(0.1)
            elif abs(place) > 0.04:
                press(page, 42.5 * place)  # half of the field of view
        page.mouse.up()
        return list(recorded(page).result.seats)


def test_a_browser_hits_an_easy_robot_by_keys_and_mouse(tmp_path: Path, browser: Any) -> None:
    # Whoever aims on a busy machine sees late, so the better of three matches counts.
    duels = (duel(tmp_path / str(number), browser) for number in range(3))
    robot = next((robot for own, robot in duels if own.hits > 0), None)
    assert robot is not None, "no hit in three matches"
    assert robot.shots > 0  # it fought back


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


def test_a_browser_that_loses_its_connection_comes_back_to_its_seat(tmp_path: Path, browser: Any) -> None:
    sockets: list[Any] = []

    # The server closes no page of this test: a routed one might still send, which Chromium calls an error.
    def pass_on(socket: Any) -> None:
        socket.connect_to_server()
        sockets.append(socket)

    with table_in_thread(face_to_face(people=2, seconds=30.0), tmp_path) as links, pages(browser) as new_page:
        host, guest = new_page(**WIDE), new_page(**WIDE)
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


def test_a_seat_is_played_in_the_page_that_was_opened_last(tmp_path: Path, browser: Any) -> None:
    with table_in_thread(face_to_face(people=2, seconds=30.0), tmp_path) as links, pages(browser) as new_page:
        host, guest, other = (new_page(**WIDE) for _ in range(3))
        guest.goto(links.guests[0])
        host.goto(links.host)
        host.wait_for_selector("#lobby li:nth-child(2)[data-where=here]")
        host.click("#go")
        wait_for_match(guest)
        other.goto(links.guests[0])
        wait_for_match(other)
        guest.wait_for_selector("#game[data-state=closed] >> text=Opened elsewhere")
        guest.click("#go")
        wait_for_match(guest)
        other.wait_for_selector("#game[data-state=closed] >> text=Opened elsewhere")
