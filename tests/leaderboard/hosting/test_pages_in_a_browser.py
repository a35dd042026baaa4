"""The season's pages in a real browser: on a phone, in the dark, without scripts, and with people at work."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.browsers import DESK, PHONE, chromium
from tests.leaderboard.agents import write_agent
from tests.leaderboard.filled_season import COOKIE, HOSTILE, PASSWORD, FilledSeason
from tests.leaderboard.hosting.clients import Site, copied_database, serving_filled

from wildscav_leaderboard.submissions.packing import pack

pytestmark = pytest.mark.slow
PAGES = {  # by who looks at them
    "visitor": (
        *("/", "/boards/navigation", "/boards/battle/head-to-head", "/teams/newts", "/matches"),
        *("/matches/{ladder}", "/matches/{playing}", "/login", "/register", "/nowhere"),
    ),
    "owner": (
        *("/boards/battle", "/teams/owls", "/submissions/{active}", "/submissions/{failed}"),
        *("/submissions/{queued}", "/matches/{suite}", "/submit", "/account"),
    ),
    "other": ("/account",),
    "organizer": (
        *("/organizer", "/organizer/submissions", "/organizer/teams", "/organizer/people"),
        *("/organizer/announcements", "/organizer/audit-log"),
    ),
}
# What the pages of matches report, since there are no records of them.
REPORTED = ("Failed to load resource", "is no longer in the season's files")
OF_COLOURS = ["color-contrast", "link-in-text-block"]  # axe's rules


@pytest.fixture(scope="module")
def arena(new_filled_season: Callable[..., FilledSeason]) -> Iterator[Site]:
    with serving_filled(
        new_filled_season(words=HOSTILE)
    ) as site:  # its matches have no records to be rendered
        yield site


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as started:
        yield started


def open_as(arena: Site, browser: Any, asker: str, **options: Any) -> Any:
    """Return a page of somebody's browser."""
    address = str(arena.client.base_url)
    context = browser.new_context(base_url=address, **options)
    if asker != "visitor":
        context.add_cookies([{"name": COOKIE, "value": arena.filled.people[asker].cookie, "url": address}])
    return context.new_page()


def address_of(arena: Site, path: str) -> str:
    return path.format(**arena.filled.submissions, **arena.filled.matches)


def test_no_page_is_wider_than_a_phone_or_breaks_its_policy(arena: Site, browser: Any) -> None:
    wide: list[str] = []
    faults: list[str] = []
    for asker, paths in PAGES.items():
        page = open_as(arena, browser, asker, viewport=PHONE)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda said: faults.append(f"{said.location['url']}: {said.text}"))
        for path in paths:
            page.goto(address_of(arena, path))
            if page.evaluate("document.documentElement.scrollWidth") > PHONE["width"]:
                wide.append(path)
        page.context.close()
    assert wide == []
    assert [fault for fault in faults if not any(known in fault for known in REPORTED)] == []


def test_nothing_keeps_people_out_of_any_page_in_light_or_in_dark_colours(arena: Site, browser: Any) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    found: list[str] = []
    for asker, paths in PAGES.items():
        page = open_as(arena, browser, asker, viewport=DESK, bypass_csp=True)
        for path in paths:
            page.emulate_media(color_scheme="light")
            page.goto(address_of(arena, path))
            for details in page.locator("details").all():
                details.evaluate("one => { one.open = true; }")
            results = {"light": axe.run(page, options={"resultTypes": ["violations"]})}
            page.emulate_media(color_scheme="dark")  # in which nothing is different but the colours
            results["dark"] = axe.run(page, options={"runOnly": OF_COLOURS, "resultTypes": ["violations"]})
            for scheme, seen in results.items():
                found += [f"{path}, {scheme}: {seen.generate_report()}"] if seen.violations_count else []
        page.context.close()
    assert found == []


def test_without_scripts_the_pages_show_everything_but_the_player(arena: Site, browser: Any) -> None:
    page = open_as(arena, browser, "owner", java_script_enabled=False)

    page.goto("/boards/battle")
    assert page.get_by_role("row").count() == 5
    assert page.get_by_role("img", name="ranks of the first").is_visible()
    page.goto(address_of(arena, "/submissions/{failed}"))
    assert page.get_by_text("<script>alert('failure')</script>").first.is_visible()
    assert page.get_by_text("wildscav check DIR").is_visible()
    page.goto(address_of(arena, "/matches/{ladder}"))
    assert page.get_by_role("row").count() == 3
    assert "Watching a match in 3D needs JavaScript" in page.content()
    page.goto("/submit")
    assert "The upload needs JavaScript" in page.content()
    page.context.close()


def test_a_newcomer_registers_makes_a_team_and_submits(arena: Site, browser: Any, tmp_path: Path) -> None:
    archive = tmp_path / "stork.tar.gz"
    pack(write_agent(tmp_path, "stork"), archive)
    with copied_database(arena.app, arena.filled, tmp_path):
        page = open_as(arena, browser, "visitor", viewport=PHONE)
        page.goto("/")
        page.get_by_role("link", name="Take part").click()
        page.get_by_label("Name").fill("newcomer")
        page.get_by_label("Password").fill(PASSWORD)
        page.get_by_role("button", name="Register").click()

        page.get_by_label("Name of the new team").fill("storks")
        page.get_by_label("Its title").fill("Storks & Co.")
        page.get_by_role("button", name="Make a team").click()
        page.get_by_text("It is shown this once").wait_for()
        page.get_by_role("button", name="Log out").click()
        page.get_by_role("link", name="Log in").first.wait_for()

        page.goto("/submit")  # leads to the page to log in, and back
        page.get_by_label("Name").fill("newcomer")
        page.get_by_label("Password").fill(PASSWORD)
        page.get_by_role("button", name="Log in").click()
        page.get_by_label("Archive of the submission's folder").set_input_files(archive)
        page.get_by_label("What is new").fill("my first one")
        page.get_by_role("button", name="Submit").click()

        page.wait_for_url("**/submissions/*")
        assert page.get_by_role("heading", level=1).text_content().strip().startswith("stork 1.0")
        assert page.get_by_text("my first one").is_visible()
        assert page.get_by_text("in the queue").is_visible()
        page.context.close()


def test_what_an_organizer_announces_and_disqualifies_is_seen_by_visitors(
    arena: Site, browser: Any, tmp_path: Path
) -> None:
    with copied_database(arena.app, arena.filled, tmp_path):
        page = open_as(arena, browser, "organizer", viewport=DESK)
        page.goto("/organizer/announcements")
        page.get_by_label("Title").fill("A new map")
        page.get_by_label("Text").fill("It has a lake.\nBring boots.")
        page.get_by_role("button", name="Announce").click()
        page.get_by_text("It has a lake.").first.wait_for()
        page.goto("/organizer/teams")
        row = page.get_by_role("row", name="Hares & Hounds")
        row.get_by_text("Disqualify", exact=False).first.click()
        row.get_by_label("Reason").fill("it read other agents' memory")
        row.get_by_role("button", name="Disqualify hares").click()
        page.get_by_role("row", name="Hares & Hounds").get_by_text("disqualified", exact=True).wait_for()
        page.goto("/organizer/audit-log")
        assert page.get_by_role("row", name="disqualify team").first.get_by_text("boss").is_visible()
        page.context.close()

        visitor = open_as(arena, browser, "visitor")
        visitor.goto("/")
        assert visitor.get_by_role("article").filter(has_text="A new map").get_by_text("lake").is_visible()
        visitor.goto("/teams/hares")
        assert visitor.get_by_text("it read other agents' memory").first.is_visible()
        visitor.context.close()
