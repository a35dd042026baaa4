"""Matches that a real browser plays, by keys and mouse."""

import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import pytest
from tests.platform.stage.playing.browsers import PATIENCE, browser, pages, start, wait_for_match
from tests.platform.stage.playing.slow_network import far_away
from tests.platform.stage.playing.tables import small_plan, table_in_thread

from wildscav_engine.record import read_record, verify_record

MIDDLE = 320  # pixels from the left edge of the window
HIGH = 200  # pixels from its upper edge
SMALL = {"width": 640, "height": 400}  # as software draws
AHEAD = 6.0  # degrees
DEGREES_PER_PIXEL = 0.12  # of the mouse, as in controls.ts
KEY_TURN = 110.0  # degrees per second, likewise

__all__ = ["browser"]

pytestmark = pytest.mark.slow


class Hands:
    """Somebody's hands on the mouse and the arrow keys."""

    def __init__(self, page: Any) -> None:
        self._page, self._x = page, MIDDLE
        page.mouse.move(MIDDLE, HIGH)

    def turn(self, degrees: float) -> None:
        """Turn right: by an arrow key if it is far or the mouse is at the edge, else by the mouse."""
        x = self._x + degrees / DEGREES_PER_PIXEL
        if abs(degrees) < 25.0 and 20 < x < 2 * MIDDLE - 20:
            self._page.mouse.move(x, HIGH)
            self._x = x
        else:
            key = "ArrowRight" if degrees > 0 else "ArrowLeft"
            self._page.keyboard.down(key)
            time.sleep(0.8 * abs(degrees) / KEY_TURN)
            self._page.keyboard.up(key)
        time.sleep(0.3)


def test_a_browser_finds_the_target_by_keys_and_mouse(tmp_path: Path, browser: Any) -> None:
    with (
        table_in_thread(small_plan(time_limit=120.0), tmp_path) as links,
        pages(browser) as new_page,
    ):
        page = new_page(viewport=SMALL)
        start(page, links.host)
        hands = Hands(page)
        goal, end = page.locator("#goal"), time.monotonic() + PATIENCE
        while page.get_attribute("#game", "data-state") == "playing" and time.monotonic() < end:
            angle = float(goal.get_attribute("data-angle"))
            if abs(angle) > AHEAD:
                page.keyboard.up("KeyW")
                hands.turn(angle)
            else:
                page.keyboard.down("KeyW")
                time.sleep(0.2)
        page.wait_for_selector("#game[data-state=over]", timeout=30_000)
        assert page.inner_text("#title").startswith("You reached the target in ")
        assert page.inner_text("#record code").endswith(".wsr")
        record = read_record(Path(page.inner_text("#record code")))
    assert record.result.seats[0].metrics["success"] == 1.0
    assert verify_record(record).holds


# Presses a key several times, and returns for each how long it took until the picture was another one, ms.
PRESSES = """async ([code, element, name]) => {
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const send = (kind) => dispatchEvent(new KeyboardEvent(kind, { code }));
  const shown = () => document.querySelector(element).dataset[name];
  const delays = [];
  for (let press = 0; press < 3; press++) {
    const [before, began] = [shown(), performance.now()];
    send("keydown");
    while (shown() === before) await new Promise(requestAnimationFrame);
    await new Promise(requestAnimationFrame); // when the picture is on the screen
    delays.push(performance.now() - began);
    await wait(150);
    send("keyup");
    await wait(700);
  }
  return delays;
}"""


def test_what_is_pressed_is_seen_before_a_far_server_can_answer(tmp_path: Path, browser: Any) -> None:
    away = 0.25  # s to the server, and as long back
    ping = 2000.0 * away  # ms
    with (
        table_in_thread(small_plan(time_limit=120.0), tmp_path) as links,
        far_away(links.host, away) as link,
        pages(browser) as new_page,
    ):
        page = new_page(viewport={"width": 320, "height": 180})
        start(page, link)
        page.wait_for_function(f"Number(document.querySelector('#delay').dataset.ping) >= {ping}")
        walked = page.evaluate(PRESSES, ["KeyW", "#picture", "place"])
        turned = page.evaluate(PRESSES, ["ArrowRight", "#compass", "yaw"])
        error = page.get_attribute("#delay", "data-error")
        sys.stdout.write(f"key to screen: {walked}, {turned} ms; 95 % expected to {error} m\n")
    assert max(median(walked), median(turned)) < ping


def test_a_page_without_gamepads_that_cannot_take_the_mouse_plays(tmp_path: Path, browser: Any) -> None:
    with table_in_thread(small_plan(), tmp_path) as links, pages(browser) as new_page:
        page = new_page(viewport=SMALL)
        page.add_init_script(
            "delete Navigator.prototype.getGamepads; delete Element.prototype.requestPointerLock"
        )
        start(page, links.host)
        page.keyboard.down("KeyW")
        page.wait_for_function("Math.abs(document.querySelector('#picture').dataset.place.split(',')[2]) > 1")


def test_without_webgl_2_one_watches_from_above_and_is_not_asked_to_play(
    tmp_path: Path, browser: Any
) -> None:
    with table_in_thread(small_plan(), tmp_path) as links, pages(browser) as new_page:
        flat, other = new_page(viewport=SMALL), new_page(viewport=SMALL)
        flat.add_init_script(
            """const usual = HTMLCanvasElement.prototype.getContext;
            HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
              return kind === "webgl2" ? null : usual.call(this, kind, ...more);
            };"""
        )
        flat.goto(links.host)
        flat.wait_for_selector("#game[data-state=lobby] #words >> text=no WebGL 2")
        assert flat.is_hidden("#go")
        flat.goto(links.watch)
        start(other, links.host)
        flat.wait_for_selector("#delay:not(:empty)", timeout=PATIENCE * 1000)
        assert flat.locator("#views button").all_inner_texts() == ["0From above"]


def test_nothing_keeps_people_out(tmp_path: Path, browser: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()

    def check(page: Any, state: str) -> None:
        page.wait_for_selector(f"#game[data-state={state}]", timeout=PATIENCE * 1000)
        found = axe.run(page, options={"resultTypes": ["violations"]})
        assert found.violations_count == 0, found.generate_report()

    with (
        table_in_thread(small_plan("battle", 60.0, people=2), tmp_path) as links,
        pages(browser) as new_page,
    ):
        page, guest = new_page(bypass_csp=True), new_page(bypass_csp=True)
        guest.goto(links.entrance)
        guest.wait_for_selector("#entry")
        found = axe.run(guest, options={"resultTypes": ["violations"]})
        assert found.violations_count == 0, found.generate_report()
        guest.click("#entry button")
        check(guest, "lobby")
        page.goto(links.host)
        check(page, "lobby")
    plan = small_plan("battle", 60.0, ("walker-easy",))
    with table_in_thread(plan, tmp_path) as links, pages(browser) as new_page:
        page, spectator = new_page(bypass_csp=True), new_page(bypass_csp=True)
        page.goto(links.host)
        check(page, "lobby")
        page.click("#go")
        wait_for_match(page)
        check(page, "playing")
        spectator.goto(links.watch)
        check(spectator, "watching")
