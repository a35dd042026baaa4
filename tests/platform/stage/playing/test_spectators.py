"""Spectators: what they see, and that they do nothing."""

import asyncio
import json
from contextlib import AsyncExitStack
from typing import Any

import httpx
import pytest
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import at_table, small_plan
from websockets.exceptions import ConnectionClosed, InvalidStatus

from wildscav_engine.simulation.match import Match
from wildscav_stage.playing.audience import AUDIENCE_FRAMES, Audience, Moment
from wildscav_stage.playing.links import Addresses
from wildscav_stage.playing.page import TOO_MANY, UNSUPPORTED
from wildscav_stage.playing.table import MAX_SPECTATORS


@at_table("battle", 60.0, ("fighter-easy",), people=2)
async def test_a_spectator_is_told_of_everybody(
    spectator: PageClient, host: PageClient, links: Addresses
) -> None:
    assert (await spectator.until("table"))["seat"] is None
    assert "links" not in (shown := await spectator.until("people"))
    assert "watch_link" not in shown
    assert (await host.until("people"))["spectators"] == 1
    await host.send(kind="start")
    first = await spectator.until("moment")
    # The host, the robot in the guest's seat, and the robot.
    assert [row[0] for row in first["agents"]] == [0, 1, 2]
    assert (first["all"], len(first["boxes"]) > 0) == (1, True)
    assert "all" not in await spectator.until("moment")
    assert spectator.rows.keys() == {0, 1, 2}
    async with page(links.watch) as later:
        assert (await later.until("moment"))["all"] == 1
        assert later.boxes == spectator.boxes


@at_table()
async def test_spectators_are_told_the_same_and_one_who_comes_to_a_paused_match_sees_it(
    spectator: PageClient, second_spectator: PageClient, host: PageClient, links: Addresses
) -> None:
    await host.send(kind="start")
    await spectator.until("moment")
    await host.send(kind="pause", paused=True)
    await asyncio.gather(spectator.until("paused"), second_spectator.until("paused"))
    await asyncio.gather(spectator.moments_within(0.3), second_spectator.moments_within(0.3))
    async with page(links.watch) as late:
        await late.until("moment")
        told = [each.rows for each in (spectator, second_spectator, late)]
    assert told[0] == told[1] == told[2]


@pytest.mark.parametrize(
    "message",
    [
        {"kind": "input", "number": 1, "forward": 1.0},
        {"kind": "start"},
        {"kind": "pause", "paused": True},
        {"kind": "rename", "name": "nobody"},
        {"kind": "free", "seat": 1},
        {"kind": "watch", "seat": 0},
    ],
)
@at_table(people=2)
async def test_a_spectator_who_tries_to_act_is_closed(
    spectator: PageClient, message: dict[str, object]
) -> None:
    await spectator.socket.send(json.dumps(message))
    with pytest.raises(ConnectionClosed, match="spectators only watch") as closed:
        await spectator.until("begin")
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == UNSUPPORTED


def spectate(match: Match, audience: Audience, frames: int, *, asked: int) -> list[tuple[int, str]]:
    """Play frames, and return what a spectator who asks after every few frames is told."""

    async def watch() -> list[tuple[int, str]]:
        audience.begin(match)
        told = [await audience.next(0)]
        for frame in range(1, frames + 1):
            match.step()
            match.state.agents.fired[0, 1] = frame in (50, 98)
            audience.note()
            if frame % asked == 0:
                told.append(await audience.next(told[-1][0]))
        newest, _ = await audience.next(0)
        while told[-1][0] < newest:
            told.append(await audience.next(told[-1][0]))
        return told

    return asyncio.run(watch())


def fighters() -> Match:
    return Match(small_plan("battle", 60.0, ("fighter",) * 3).spec)


@pytest.mark.parametrize("seen", [1, 3])
def test_changes_add_up_to_what_is_there(seen: int) -> None:
    """Whoever takes every moment, or is a few late at times, knows what one knows who comes now."""
    audience, match, client = Audience(), fighters(), PageClient.__new__(PageClient)
    told = spectate(match, audience, 400, asked=AUDIENCE_FRAMES * seen)

    for _, text in told:
        client._take_rows(json.loads(f"{{{text}"))
    everything = json.loads(f"{{{asyncio.run(audience.next(0))[1]}")

    assert (sum('"all"' in text for _, text in told) == 1) == (seen == 1)
    assert client.rows == {seat: row for seat, *row in everything["agents"]}


def test_a_spectator_who_missed_moments_is_told_everything_and_no_old_shots() -> None:
    told = spectate(fighters(), Audience(), 100, asked=50)

    texts = [json.loads(f"{{{text}") for _, text in told]
    assert [text.get("all") for text in texts] == [1, 1, 1]
    assert "shots" not in texts[1]  # they are old
    assert texts[2]["shots"][0][0] == 1


def test_changes_are_small() -> None:
    told = spectate(Match(small_plan("battle", 60.0, ("fighter",) * 9).spec), Audience(), 500, asked=4)

    rate = 50 / AUDIENCE_FRAMES
    assert rate * sum(len(text) for _, text in told[1:]) / len(told[1:]) < 5000  # bytes a second


@at_table("battle", 2.0, people=2, delay=1000.0)
async def test_what_spectators_see_is_so_many_seconds_old(
    spectator: PageClient, host: PageClient, links: Addresses, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of all that tells where somebody is, and of the end: here, these seconds pass after the match."""
    later: list[tuple[Any, Any]] = []
    loop = asyncio.get_running_loop()
    call_later = loop.call_later

    def hold(delay: float, callback: Any, *values: Any, **options: Any) -> Any:
        if delay == 1000.0:
            return later.append((callback, values))
        return call_later(delay, callback, *values, **options)

    monkeypatch.setattr(loop, "call_later", hold)
    assert small_plan(people=2).delay > 0.0
    assert (await spectator.until("table"))["delay"] == 1000.0
    await host.send(kind="start")
    await host.until("over")
    async with page(links.watch) as late:
        await late.until("lobby")  # to spectators, none has begun
    for callback, values in later:
        callback(*values)
    await spectator.until("begin")
    await spectator.until("over")
    told = [values[0] for _, values in later]
    order = ["moment" if isinstance(each, Moment) else each and each["kind"] for each in told]
    assert order.index("begin") < order.index("moment")
    last = max(place for place, kind in enumerate(order) if kind == "moment")
    assert last < order.index("over")
    assert json.loads(f"{{{told[last].everything}")["frame"] >= 96  # nothing of the match is left out


@at_table()
async def test_the_map_is_sent_to_whoever_has_a_link_and_does_not_have_it_yet(
    host: PageClient, links: Addresses
) -> None:
    def status(link: str, **headers: str) -> int:
        return httpx.get(f"{link}/map", trust_env=False, headers=headers).status_code

    def key(link: str) -> str:
        return httpx.get(f"{link}/map", trust_env=False).headers["ETag"]

    assert await asyncio.to_thread(status, links.host) == 404  # there is none yet
    await host.send(kind="start")
    named = (await host.until("begin"))["map"]
    for link, expected in ((links.host, 200), (links.watch, 200), (f"{links.host}x", 404)):
        assert await asyncio.to_thread(status, link) == expected
    kept = {"If-None-Match": await asyncio.to_thread(key, links.host)}
    assert kept["If-None-Match"] == f'"{named}"'  # so pages notice another map
    assert await asyncio.to_thread(status, links.watch, **kept) == 304


@at_table(people=2)
async def test_links_of_spectators_and_of_people_open_their_own_pages_alone(links: Addresses) -> None:
    for link, options in (
        (links.watch.replace("/watch/", "/play/"), {}),
        (f"{links.host}x", {}),
        (links.host, {"origin": "http://example.org"}),  # another site's page that knows the link
    ):
        with pytest.raises(InvalidStatus, match="403"):
            async with page(link, **options):
                pass
    async with page(links.host.replace("/play/", "/watch/")) as player:
        with pytest.raises(ConnectionClosed, match="whoever plays does not watch"):
            await player.until("table")


@at_table()
async def test_there_is_room_for_so_many_spectators(links: Addresses) -> None:
    async with AsyncExitStack() as stack:
        for _ in range(MAX_SPECTATORS):
            spectator = await stack.enter_async_context(page(links.watch))
            await spectator.until("lobby")
        one_more = await stack.enter_async_context(page(links.watch))
        with pytest.raises(ConnectionClosed, match=f"{MAX_SPECTATORS} people watch already") as closed:
            await one_more.until("lobby")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == TOO_MANY
        await spectator.socket.close()
        async with page(links.host) as host:  # who plays has room
            while (await host.until("people"))["spectators"] >= MAX_SPECTATORS:
                pass
        await (await stack.enter_async_context(page(links.watch))).until("lobby")
