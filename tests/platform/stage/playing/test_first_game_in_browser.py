"""A person's first game in a browser: keys of their own, the first steps, and the shooting range."""

from pathlib import Path
from typing import Any

import pytest
from tests.platform.stage.playing.browsers import PATIENCE, browser, pages, start, wait_for_match
from tests.platform.stage.playing.tables import table_in_thread

from wildscav_engine.record import read_record, verify_record
from wildscav_stage.playing.plan import make_range

SMALL = {"viewport": {"width": 640, "height": 480}, "bypass_csp": True}  # as software draws
SECONDS = 25.0  # of game time, in which the browser takes all steps and shoots

__all__ = ["browser"]

pytestmark = pytest.mark.slow


def hold_until(page: Any, key: str, words: str) -> None:
    """Hold a key until the page asks for something else."""
    page.keyboard.down(key)
    page.wait_for_selector(f"#lesson:not(.done) >> text={words}", timeout=PATIENCE * 1000)
    page.keyboard.up(key)


def test_a_person_chooses_keys_and_the_page_keeps_them(tmp_path: Path, browser: Any) -> None:
    with table_in_thread(make_range(3, 60.0), tmp_path) as links, pages(browser) as new_page:
        page = new_page(**SMALL)
        page.goto(links.host)
        page.click("#bindings summary")
        page.click("[data-act='jump 1']")
        page.keyboard.press("Escape")  # leaves it as it is
        page.click("[data-act='jump 1']")
        page.keyboard.press("r")
        page.wait_for_selector("#bindings [role=status] >> text=R did something else: reload.")
        page.reload()
        page.wait_for_selector("#keys >> text=Space or Rjump")
        page.click("#bindings summary")
        page.click("#bindings >> text=Reset all")
        page.wait_for_selector("#keys >> text=Rreload")


def test_the_first_steps_end_when_they_are_done_and_the_range_counts_shots(
    tmp_path: Path, browser: Any
) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()

    def check() -> None:
        found = axe.run(page, options={"resultTypes": ["violations"]})
        assert found.violations_count == 0, found.generate_report()

    with table_in_thread(make_range(3, SECONDS), tmp_path) as links, pages(browser) as new_page:
        page = new_page(**SMALL)
        start(page, links.host)
        wait_for_match(page)
        page.wait_for_selector("#lesson >> text=Look around with the mouse")
        hold_until(page, "ArrowLeft", "Walk with W A S D")
        hold_until(page, "KeyW", "Jump with Space")
        hold_until(page, "Space", "Shoot with left button")  # there are no boxes at the range
        hold_until(page, "KeyF", "Reload with R")
        page.keyboard.press("Enter")
        page.wait_for_selector("#lesson", state="hidden")
        page.wait_for_selector("#game[data-state=over]", timeout=PATIENCE * 1000)
        assert " shots hit (" in page.inner_text("#title")
        assert page.locator("#result tbody tr").count() == 7
        check()
        record = read_record(Path(page.inner_text("#record code")))
        page.click("#go")
        wait_for_match(page)
        assert page.is_hidden("#lesson")  # never again
        page.keyboard.press("Escape")
        page.wait_for_selector("#game[data-state=paused]")
        assert page.evaluate("document.activeElement.id") == "go"
        page.click("#teach")
        page.click("#bindings summary")
        page.click("[data-act='jump 1']")
        check()
    assert verify_record(record).holds
    assert record.result.seats[0].shots > 0
