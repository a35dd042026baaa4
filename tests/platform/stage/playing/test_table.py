"""Matches of a person at a real table: a match server, a web server, and a WebSocket as a page opens it."""

import asyncio
from pathlib import Path
from urllib.request import ProxyHandler, build_opener

import pytest
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import at_table
from websockets.exceptions import ConnectionClosed

from wildscav_engine.record import read_record, verify_record
from wildscav_stage.playing import table
from wildscav_stage.playing.links import Addresses
from wildscav_stage.playing.page import MAX_UNSEEN
from wildscav_stage.viewer_files import versioned

YAW, COUNTS_START = 3, 9  # in a seat's row


@at_table(time_limit=2.0)
async def test_a_match_ends_in_a_record_that_holds(person: PageClient) -> None:
    assert (await person.until("table"))["names"] == ["person"]
    await person.until("lobby")
    await person.send(kind="start")
    await person.until("begin")
    await person.send(kind="input", number=1, forward=1.0, turn=90.0)
    over = await person.until("over")
    assert person.shown["input"] == 1
    assert person.shown["own"][COUNTS_START] == 100  # hp
    record = read_record(Path(str(over["record"])))
    assert verify_record(record).holds
    assert record.names == ("person",)
    assert over["rows"][0]["values"][0] == record.result.seats[0].metrics["time"]  # type: ignore[index]
    actions = record.actions[:, 0]
    assert (actions[:, 2] == 90.0).sum() == 1  # the view was turned once,
    assert (actions[-1, 1] == 10.0).all()  # and W was held to the end


@at_table()
async def test_inputs_turn_the_view(person: PageClient) -> None:
    await person.send(kind="start")
    before = (await person.until("moment"))["own"][YAW]
    await person.send(kind="input", number=5, turn=25.0)
    while person.shown["input"] < 5:
        await person.until("moment")
    after = person.shown["own"][YAW]
    assert (after - before) % 36000 == 2500  # hundredths of a degree


@at_table("battle", 60.0, ("fighter-easy",))
async def test_a_match_against_robots_waits_while_it_is_paused(person: PageClient) -> None:
    await person.send(kind="start")
    await person.until("moment")
    await person.send(kind="pause", paused=True)
    assert (await person.until("paused"))["paused"]
    assert await person.moments_within(1.0) <= MAX_UNSEEN  # those that were on their way
    await person.send(kind="pause", paused=False)
    assert not (await person.until("paused"))["paused"]
    await person.until("moment")


@at_table()
async def test_a_match_against_robots_waits_for_a_page_that_was_closed(links: Addresses) -> None:
    async with page(links.host) as first:
        await first.send(kind="start")
        await first.until("moment")
    await asyncio.sleep(0.2)
    async with page(links.host) as second:
        assert (await second.until("begin"))["paused"]


@at_table()
async def test_whoever_opens_the_link_again_goes_on_there(person: PageClient, links: Addresses) -> None:
    await person.send(kind="start")
    frame = 0
    while not frame:
        frame = (await person.until("moment"))["frame"]
    async with page(links.host) as second:
        assert not (await second.until("begin"))["paused"]
        with pytest.raises(ConnectionClosed) as closed:
            await person.until("over")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 4001
        while (await second.until("moment"))["frame"] <= frame:
            pass  # both may have come before the first step


@pytest.mark.parametrize(
    ("message", "code"), [('{"kind": "input", "number": 1, "forward": 2}', 1003), ("x" * 40_000, 1009)]
)
@at_table()
async def test_a_page_that_sends_anything_else_is_closed(person: PageClient, message: str, code: int) -> None:
    await person.socket.send(message)
    with pytest.raises(ConnectionClosed) as closed:
        await person.until("over")
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == code


@at_table()
async def test_pages_load_nothing_from_elsewhere_and_name_the_version_of_their_script(
    links: Addresses, viewer: Path
) -> None:
    (viewer / "play.js").write_text("1")

    def ask(address: str) -> tuple[str, bytes]:
        with build_opener(ProxyHandler({})).open(address) as answer:
            return answer.headers["Content-Security-Policy"], answer.read()

    policy, content = await asyncio.to_thread(ask, links.host)
    assert policy.startswith("default-src 'none'; script-src 'self'; ")
    assert "unsafe" not in policy
    assert b"//" not in content
    assert f'src="../static/viewer/{versioned("play.js")}"'.encode() in content
    style = f"{links.host.partition('/play/')[0]}/static/play.css"
    assert b"://" not in (await asyncio.to_thread(ask, style))[1]


@at_table()
async def test_a_page_is_told_of_any_failure(person: PageClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("a mistake of ours")

    monkeypatch.setattr(table, "hosted_match", fail)
    await person.send(kind="start")
    assert (await person.until("failed"))["message"] == "a mistake of ours"
