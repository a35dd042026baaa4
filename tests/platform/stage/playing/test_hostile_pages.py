"""What pages that mean harm can do to the match of others: nothing."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any, cast
from urllib.parse import urlsplit

import pytest
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import at_table
from websockets.exceptions import ConnectionClosed

from wildscav_engine.record import read_record, verify_record
from wildscav_stage.playing.links import Addresses
from wildscav_stage.playing.page import MAX_MESSAGES, MAX_UNSEEN, OpenPage

Attack = Callable[[PageClient], Awaitable[None]]


async def garbage(guest: PageClient) -> None:
    await guest.socket.send(bytes(range(256)))


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
@pytest.mark.parametrize("attack", [garbage, huge_message, act_for_another, flood])
@at_table("navigation", 0.8, people=2)
async def test_the_attacker_is_closed_and_the_match_of_the_others_goes_on(
    host: PageClient, guest: PageClient, attack: Attack
) -> None:
    await host.send(kind="start")
    await asyncio.gather(host.until("moment"), guest.until("moment"))
    with pytest.raises(ConnectionClosed):
        await attacked(guest, attack)
    record = read_record(Path((await host.until("over"))["record"]))
    assert record.steps == 40  # all of its 0.8 s
    assert not record.actions[:, 0].any()  # nobody acted for the host
    assert verify_record(record).holds


@at_table("navigation", 1.0, people=2)
async def test_a_page_that_stops_reading_stops_nobody(host: PageClient, links: Addresses) -> None:
    async with page(links.guests[0], max_queue=1) as deaf:  # which reads nothing
        await host.send(kind="start")
        assert verify_record(read_record(Path((await host.until("over"))["record"]))).holds
        deaf.socket.transport.abort()


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
