"""Spectators: what they see, and that they do nothing."""

import asyncio
import json
from contextlib import AsyncExitStack
from pathlib import Path

import httpx
import pytest
from tests.platform.stage.playing.pages import page
from tests.platform.stage.playing.tables import small_plan, tables_links
from websockets.exceptions import ConnectionClosed, InvalidStatus

from wildscav_engine.simulation.match import Match
from wildscav_stage.playing.audience import Audience
from wildscav_stage.playing.page import TOO_MANY, UNSUPPORTED
from wildscav_stage.playing.table import MAX_SPECTATORS


def test_a_spectator_is_told_of_everybody(tmp_path: Path) -> None:
    async def play() -> None:
        plan = small_plan("battle", 60.0, ("fighter-easy",), people=2)
        async with tables_links(plan, tmp_path) as links, AsyncExitStack() as stack:
            spectator, host = [
                await stack.enter_async_context(page(link)) for link in (links.watch, links.host)
            ]
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
            async with page(links.watch) as later:
                assert (await later.until("moment"))["all"] == 1
                assert later.boxes == spectator.boxes

    asyncio.run(play())


def test_spectators_are_told_the_same_and_one_who_comes_to_a_paused_match_sees_it(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan(), tmp_path) as links, AsyncExitStack() as stack:
            links_of_all = (links.watch, links.watch, links.host)
            first, second, host = [await stack.enter_async_context(page(link)) for link in links_of_all]
            await host.send(kind="start")
            await first.until("moment")
            await host.send(kind="pause", paused=True)
            await asyncio.gather(first.until("paused"), second.until("paused"))
            await asyncio.gather(first.moments_within(0.3), second.moments_within(0.3))
            async with page(links.watch) as late:
                await late.until("moment")
                told = [each.shown["agents"] for each in (first, second, late)]
            assert told[0] == told[1] == told[2]

    asyncio.run(play())


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
def test_a_spectator_who_tries_to_act_is_closed(tmp_path: Path, message: dict[str, object]) -> None:
    async def play() -> None:
        async with tables_links(small_plan(people=2), tmp_path) as links, page(links.watch) as spectator:
            await spectator.socket.send(json.dumps(message))
            with pytest.raises(ConnectionClosed, match="spectators only watch") as closed:
                await spectator.until("begin")
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == UNSUPPORTED

    asyncio.run(play())


def test_messages_are_made_for_those_who_take_them() -> None:
    async def watch() -> None:
        match, audience = Match(small_plan("battle", 60.0, ("fighter",) * 3).spec), Audience()
        audience.begin(match)
        told = []
        for frame in range(1, 101):
            match.step()
            match.state.agents.fired[0, 1] = frame in (50, 98)
            audience.note()
            if frame in (60, 100):
                told.append(await audience.next(0))
        (_, before), (number, now) = told
        assert '"shots"' not in before  # they are old
        assert json.loads(f"{{{now}")["shots"][0][0] == 1
        assert await audience.next(0) == (number, now)

    asyncio.run(watch())


def test_the_map_is_sent_to_whoever_has_a_link_and_does_not_have_it_yet(tmp_path: Path) -> None:
    def status(link: str, **headers: str) -> int:
        return httpx.get(f"{link}/map", trust_env=False, headers=headers).status_code

    def key(link: str) -> str:
        return httpx.get(f"{link}/map", trust_env=False).headers["ETag"]

    async def play() -> None:
        async with tables_links(small_plan(), tmp_path) as links, page(links.host) as host:
            assert await asyncio.to_thread(status, links.host) == 404  # there is none yet
            await host.send(kind="start")
            await host.until("begin")
            for link, expected in ((links.host, 200), (links.watch, 200), (f"{links.host}x", 404)):
                assert await asyncio.to_thread(status, link) == expected
            kept = {"If-None-Match": await asyncio.to_thread(key, links.host)}
            assert await asyncio.to_thread(status, links.watch, **kept) == 304

    asyncio.run(play())


def test_links_of_spectators_and_of_people_open_their_own_pages_alone(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan(people=2), tmp_path) as links:
            with pytest.raises(InvalidStatus, match="403"):
                async with page(links.watch.replace("/watch/", "/play/")):
                    pass
            async with page(links.host.replace("/play/", "/watch/")) as player:
                with pytest.raises(ConnectionClosed, match="whoever plays does not watch"):
                    await player.until("table")

    asyncio.run(play())


def test_there_is_room_for_so_many_spectators(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan(), tmp_path) as links, AsyncExitStack() as stack:
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

    asyncio.run(play())
