"""What pages that mean harm can do to the match of others: nothing."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any, cast
from urllib.parse import urlsplit

import pytest
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import at_table, small_plan, tables_links
from websockets.exceptions import ConnectionClosed

from wildscav_engine.record import read_record, verify_record
from wildscav_stage.playing.links import Addresses
from wildscav_stage.playing.page import MAX_MESSAGES, MAX_UNSEEN, OpenPage

Attack = Callable[[PageClient], Awaitable[None]]


async def garbage(guest: PageClient) -> None:
    await guest.socket.send(bytes(range(256)))


async def nonsense(guest: PageClient) -> None:
    await guest.socket.send("{" * 4000)


async def huge_message(guest: PageClient) -> None:
    await guest.socket.send("x" * 2**20)


async def act_for_another(guest: PageClient) -> None:
    await guest.send(kind="input", number=1, seat=0, forward=1.0)


async def flood(guest: PageClient) -> None:
    for number in range(2 * MAX_MESSAGES + 1):
        await guest.send(kind="input", number=number, forward=1.0)


async def attacked(guest: PageClient, attack: Attack) -> None:
    """Attack, and go on until the server closes the page."""
    await attack(guest)
    await guest.until("over")


@pytest.mark.slow
@pytest.mark.parametrize("attack", [garbage, nonsense, huge_message, act_for_another, flood])
def test_the_attacker_is_closed_and_the_match_of_the_others_goes_on(tmp_path: Path, attack: Attack) -> None:
    async def play() -> Path:
        plan = small_plan("navigation", 0.8, people=2)
        async with tables_links(plan, tmp_path) as links, AsyncExitStack() as stack:
            host, guest = [
                await stack.enter_async_context(page(link)) for link in (links.host, *links.guests)
            ]
            await host.send(kind="start")
            await asyncio.gather(host.until("moment"), guest.until("moment"))
            with pytest.raises(ConnectionClosed):
                await attacked(guest, attack)
            return Path((await host.until("over"))["record"])

    record = read_record(asyncio.run(play()))
    assert record.steps == 40  # all of its 0.8 s
    assert not record.actions[:, 0].any()  # nobody acted for the host
    assert verify_record(record).holds


def test_a_page_that_stops_reading_stops_nobody(tmp_path: Path) -> None:
    async def play() -> Path:
        plan = small_plan("navigation", 1.0, people=2)
        async with tables_links(plan, tmp_path) as links, AsyncExitStack() as stack:
            host = await stack.enter_async_context(page(links.host))
            deaf = await stack.enter_async_context(page(links.guests[0], max_queue=1))  # which reads nothing
            stack.callback(deaf.socket.transport.abort)
            await host.send(kind="start")
            return Path((await host.until("over"))["record"])

    assert verify_record(read_record(asyncio.run(play()))).holds


def test_a_page_that_has_seen_what_it_was_not_sent_costs_no_memory() -> None:
    class Socket:
        async def send_text(self, text: str) -> None:
            assert text

    async def play() -> None:
        page = OpenPage(cast("Any", Socket()))
        for _ in range(10 * MAX_UNSEEN):
            await page._send_moment("now", "}")
            page._note_seen(2**53)
        assert (page._sent_at, page.ping) == ({}, None)

    asyncio.run(play())


@at_table("navigation", 1.0)
async def test_connections_that_say_nothing_do_not_keep_people_from_their_match(links: Addresses) -> None:
    async with AsyncExitStack() as stack:
        address = urlsplit(links.host)
        for _ in range(50):
            _, silent = await asyncio.open_connection(address.hostname, address.port)
            stack.callback(silent.close)
        host = await stack.enter_async_context(page(links.host))
        await host.send(kind="start")
        await host.until("over")
