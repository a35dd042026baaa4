"""Spectators: what they see, and that they do nothing."""

import asyncio
import io
import json
from contextlib import AsyncExitStack
from pathlib import Path

import pytest
from PIL import Image
from tests.platform.stage.pages import page
from tests.platform.stage.tables import small_plan, tables_links
from websockets.exceptions import ConnectionClosed, InvalidStatus

from wildscav_engine.record import read_record, verify_record
from wildscav_stage.page import TOO_MANY, UNSUPPORTED
from wildscav_stage.table import MAX_SPECTATORS


def test_a_spectator_sees_everybody_from_above_or_through_any_eyes(tmp_path: Path) -> None:
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
            above = await spectator.until("picture")
            assert above["seat"] is None
            assert {label["seat"] for label in above["labels"]} == {0, 1, 2}
            assert all(0 < label["x"] < 1 and 0 < label["y"] < 1 for label in above["labels"])
            assert Image.open(io.BytesIO(spectator.picture)).size == (640, 360)
            for seat in range(3):  # the host, the robot in the guest's seat, and the robot
                await spectator.send(kind="watch", seat=seat)
                while spectator.shown["seat"] != seat:
                    await spectator.until("picture")
                assert spectator.shown["health"] <= 100
            await spectator.send(kind="watch", seat=None)
            while spectator.shown["seat"] is not None:
                await spectator.until("picture")

    asyncio.run(play())


def test_who_watches_the_same_gets_the_same_pictures(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan(), tmp_path) as links, AsyncExitStack() as stack:
            links_of_all = (links.watch, links.watch, links.host)
            first, second, host = [await stack.enter_async_context(page(link)) for link in links_of_all]
            await first.send(kind="watch", seat=0)
            await second.send(kind="watch", seat=0)
            await host.send(kind="start")
            await first.until("picture")
            await host.send(kind="pause", paused=True)
            await asyncio.gather(first.until("paused"), second.until("paused"))
            await asyncio.gather(first.pictures_within(0.3), second.pictures_within(0.3))
            assert first.shown["time"] == second.shown["time"]
            assert first.picture == second.picture

    asyncio.run(play())


@pytest.mark.parametrize(
    "message",
    [
        {"kind": "input", "number": 1, "forward": 1.0},
        {"kind": "start"},
        {"kind": "pause", "paused": True},
        {"kind": "rename", "name": "nobody"},
        {"kind": "renew", "seat": 1},
        {"kind": "watch", "seat": -1},
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


def test_a_seat_that_is_not_there_has_no_pictures(tmp_path: Path) -> None:
    async def play() -> None:
        plan = small_plan("navigation", 1.0)
        async with (
            tables_links(plan, tmp_path) as links,
            page(links.watch) as spectator,
            page(links.host) as host,
        ):
            await spectator.send(kind="watch", seat=7)
            await host.send(kind="start")
            await spectator.until("over")
            assert spectator.pictures == 0
            record = read_record(Path((await host.until("over"))["record"]))
            assert verify_record(record).holds

    asyncio.run(play())


def test_links_of_spectators_and_of_people_open_their_own_pages_alone(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan(people=2), tmp_path) as links:
            for link in (links.watch.replace("/watch/", "/play/"), links.host.replace("/play/", "/watch/")):
                with pytest.raises(InvalidStatus, match="403"):
                    async with page(link):
                        pass

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
