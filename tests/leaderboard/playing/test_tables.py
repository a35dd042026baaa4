"""Tables on a season's site: real processes, the real sandbox, and a real browser."""

import asyncio
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import pytest
from fastapi import FastAPI
from tests.browsers import DESK, IN_3D, chromium
from tests.leaderboard.filled_season import COOKIE, FilledSeason
from tests.leaderboard.hosting.clients import serving
from tests.leaderboard.seasons_made import changed
from tests.platform.stage.playing.browsers import PATIENCE, wait_for_match
from tests.platform.stage.playing.pages import page as page_of
from websockets.exceptions import ConnectionClosed

from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES
from wildscav_evaluator.sandbox.choose import missing_promises
from wildscav_leaderboard.hosting.request_log import WebCounts
from wildscav_leaderboard.playing.tables import ENDED, READY, OpenTable, TableCounts, Tables, Wish
from wildscav_leaderboard.seasons.settings import Execution, Play
from wildscav_leaderboard.submissions.service import find_submission

pytestmark = pytest.mark.slow


class Site(NamedTuple):
    """A served season on whose site people may play."""

    filled: FilledSeason
    app: FastAPI
    address: str
    counts: TableCounts

    def counted(self) -> dict[str, float]:
        """Return how many tables there are, and how many have ended in which way."""
        samples = (sample for metric in self.counts.collect() for sample in metric.samples)
        kept = (sample for sample in samples if not sample.name.endswith("_created"))
        return {sample.labels.get("outcome", "open"): sample.value for sample in kept}

    @property
    def tables(self) -> Tables:
        tables: Tables = self.app.state.tables
        return tables

    def open(self, refused: Callable[[], str] = str) -> OpenTable:
        """Open a table, and wait until it is ready."""
        number = self.filled.submissions["active"]
        with self.filled.database.reading() as session:
            one = find_submission(session, number)
            wish = Wish("me", number, one.archive, one.entrant, "night-owl", "navigation", self.address)
        table = self.tables.open(wish, refused)
        wait(lambda: table.state != "starting")
        assert table.state == READY, table.why
        return table


@contextmanager
def site(filled: FilledSeason, sandbox: str, **play: Any) -> Iterator[Site]:
    season = changed(filled.season, play=Play(enabled=True, **play), execution=Execution(sandbox=sandbox))
    counts = WebCounts()
    with serving(season, filled.database, renders=True, counts=counts) as (app, client):
        yield Site(filled, app, str(client.base_url).rstrip("/"), counts.tables)


def wait(condition: Any) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def descendants() -> dict[int, str]:
    """Return the command lines of all processes that come from this one."""
    parents: dict[int, int] = {}
    commands: dict[int, str] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            stat, command = (folder / "stat").read_text(), (folder / "cmdline").read_text()
        except (OSError, UnicodeDecodeError):
            continue
        parents[int(folder.name)] = int(stat.rpartition(")")[2].split()[1])
        commands[int(folder.name)] = command.replace("\0", " ")
    own = {os.getpid()}
    while more := {one for one, parent in parents.items() if parent in own} - own:
        own |= more
    return {number: commands[number] for number in own if number in commands and number != os.getpid()}


def code_and_reason(closed: ConnectionClosed) -> tuple[int, str]:
    assert closed.rcvd is not None
    return closed.rcvd.code, closed.rcvd.reason


def test_somebody_plays_by_keys_against_a_submission_in_the_sandbox(hostile_season: FilledSeason) -> None:
    if why := missing_promises(SANDBOXES["bubblewrap"], DEFAULT_LIMITS):
        pytest.skip(f"needs bubblewrap: {why}")
    filled, before = hostile_season, descendants()
    with site(filled, "bubblewrap", idle=10.0) as served_site, chromium(*IN_3D) as browser:
        context = browser.new_context(viewport=DESK, base_url=served_site.address)
        cookie = {"name": COOKIE, "value": filled.people["other"].cookie, "url": served_site.address}
        context.add_cookies([cookie])
        page, faults = context.new_page(), []
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(f"/submissions/{filled.submissions['active']}")
        page.get_by_role("button", name="Play battle").click()
        # Another page waits first.
        page.wait_for_selector("#game[data-state=lobby]", timeout=PATIENCE * 1000)
        assert "Also in the match: night-owl 1.1" in page.inner_text("#next")
        page.click("#go")
        wait_for_match(page)

        sandboxed = [command for command in descendants().values() if command.startswith("bwrap ")]
        assert sandboxed
        assert "--unshare-" in sandboxed[0]
        yaw = float(page.get_attribute("#compass", "data-yaw"))
        page.keyboard.down("ArrowRight")
        page.wait_for_function(
            "yaw => Math.abs(Number(document.querySelector('#compass').dataset.yaw) - yaw) > 5",
            arg=yaw,
            timeout=PATIENCE * 1000,
        )
        page.keyboard.up("ArrowRight")
        assert faults == []
        # Nobody learns where files are, and other people's pages are not opened by guessing.
        assert "/records" not in page.content()
        assert context.request.get(page.url[:-4] + "wxyz").status == 404

        (table,) = served_site.tables._tables.values()
        address = page.url
        context.close()
        wait(lambda: table.state == ENDED)
        assert table.why == "you left"
        visitor = browser.new_page()
        visitor.goto(address)
        assert "this game is over: you left" in visitor.content()
    left = {number: command for number, command in descendants().items() if number not in before}
    assert not [command for command in left.values() if "wildscav" in command]


def test_a_guest_comes_by_the_code_and_both_watch_the_match_afterwards(hostile_season: FilledSeason) -> None:
    with site(hostile_season, "process", people=2, match=10.0) as served_site:
        table = served_site.open()

        async def play() -> dict[str, Any]:
            async with page_of(f"{served_site.address}{table.path}") as host:
                told = (await host.until("people"))["room"]
                assert (table.code, len(told["code"])) == (told["code"], 6)
                assert told["link"].startswith(f"{served_site.address}{table.base_path}join?code=")
                async with httpx.AsyncClient(trust_env=False, follow_redirects=True) as browser:
                    wrong = await browser.post(told["link"], data={"code": "BCDFGH"})
                    assert (wrong.status_code, "not valid" in wrong.text) == (403, True)
                    code = {"code": table.code.lower()}
                    sent = await browser.post(f"{served_site.address}/play", data=code)
                    assert sent.status_code == 200
                    guests = str(sent.url)
                    async with page_of(guests) as guest:
                        assert (await guest.until("table"))["seat"] == 1
                        await host.send(kind="start")
                        over = await guest.until("over")
                    secret = over["match"].pop("secret")
                    address = f"{served_site.address}{table.base_path}matches/{secret}"
                    shown = await browser.get(address)
                    assert (shown.status_code, "night-owl" in shown.text) == (200, True)
                    while (trails := await browser.get(f"{address}/trails")).status_code == 202:
                        pass  # it is being prepared
                    assert trails.json()["seats"]
                    assert (await browser.get(f"{address}/record")).status_code == 404
            return over

        over = asyncio.run(play())
        assert over["match"] == {"record": None}  # records stay on the server
        assert "commands" not in over


@pytest.mark.parametrize(
    ("play", "why"),
    [({"session": 10.0}, "your time of 10 s is over"), ({"idle": 5.0}, "you did nothing for 5 s")],
)
def test_a_page_is_told_when_the_time_is_over(
    hostile_season: FilledSeason, play: dict[str, float], why: str
) -> None:
    with site(hostile_season, "process", **play) as served_site:
        table = served_site.open()
        assert served_site.counted() == {"open": 1}

        async def look_on() -> tuple[int, str]:
            async with page_of(f"{served_site.address}{table.path}") as page:
                await page.send(kind="start")
                with pytest.raises(ConnectionClosed) as closed:
                    await page.until("the end")
                return code_and_reason(closed.value)

        assert asyncio.run(look_on()) == (4005, why)
        wait(lambda: table.state == ENDED)
        assert served_site.counted() == {"open": 0, "over": 1}


def test_a_game_is_played_from_its_own_site_until_its_submission_is_disqualified(
    hostile_season: FilledSeason,
) -> None:
    said = [""]
    with site(hostile_season, "process") as served_site:
        table = served_site.open(lambda: said[0])

        async def open_from(origin: str) -> Any:
            async with page_of(f"{served_site.address}{table.path}", origin=origin) as page:
                return (await page.read())["kind"]

        with pytest.raises(ConnectionClosed) as closed:
            asyncio.run(open_from("https://elsewhere.example"))
        assert code_and_reason(closed.value) == (4005, "another site opened this game")
        assert asyncio.run(open_from(served_site.address)) == "table"

        said[0] = "submission 1 is disqualified"
        wait(lambda: table.state == ENDED)
        assert table.why == "submission 1 is disqualified"


def test_a_table_that_cannot_be_opened_says_so(hostile_season: FilledSeason) -> None:
    with site(hostile_season, "process") as served_site:
        wish = Wish("me", 1, "gone.tar.gz", "night-owl-1", "night-owl", "battle", served_site.address)
        table = served_site.tables.open(wish)
        wait(lambda: table.state == ENDED)
        assert table.failed
        assert served_site.counted() == {"open": 0, "failed": 1}
        assert "the organizers can see" in table.why
        assert str(hostile_season.season.folder) not in table.why
