"""Matches that a real browser plays, by keys and mouse."""

import time
from pathlib import Path
from typing import Any

import pytest
from tests.platform.stage.browsers import PATIENCE, browser, pages, start
from tests.platform.stage.tables import small_plan, table_in_thread

from wildscav_engine.record import read_record, verify_record

MIDDLE = 640  # pixels from the left edge of the window
AHEAD = 6.0  # degrees
DEGREES_PER_PIXEL = 0.12  # of the mouse, as in controls.js
KEY_TURN = 110.0  # degrees per second, likewise

__all__ = ["browser"]

pytestmark = pytest.mark.slow


class Hands:
    """Somebody's hands on the mouse and the arrow keys."""

    def __init__(self, page: Any) -> None:
        self._page, self._x = page, MIDDLE
        page.mouse.move(MIDDLE, 400)

    def turn(self, degrees: float) -> None:
        """Turn right: by an arrow key if it is far or the mouse is at the edge, else by the mouse."""
        x = self._x + degrees / DEGREES_PER_PIXEL
        if abs(degrees) < 25.0 and 20 < x < 2 * MIDDLE - 20:
            self._page.mouse.move(x, 400)
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
        page = new_page(viewport={"width": 1280, "height": 800})
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
