"""Who comes to a table by a code, and who does not."""

import asyncio
import re
from collections.abc import Callable
from contextlib import AsyncExitStack
from pathlib import Path

import httpx
import pytest
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import at_table, small_plan, tables_links
from websockets.exceptions import ConnectionClosed

from wildscav_engine.simulation.match import Match
from wildscav_stage.playing.audience import Audience
from wildscav_stage.playing.links import Addresses
from wildscav_stage.playing.page import SEATED
from wildscav_stage.playing.room import LASTING, LETTERS, MAX_TRIES, EntryError, Room


def opened_at(now: list[float]) -> Room:
    room = Room(lambda: now[0])
    room.open()
    return room


def code_of(links: Addresses) -> str:
    return links.entrance.partition("code=")[2]


async def enter(links: Addresses, code: str) -> httpx.Response:
    address = links.entrance.partition("?")[0]
    return await asyncio.to_thread(httpx.post, address, data={"code": code}, trust_env=False)


def test_a_code_is_six_letters_that_nobody_confuses() -> None:
    codes = {opened_at([0.0]).code for _ in range(100)}
    assert len(codes) == 100
    assert all(re.fullmatch(f"[{LETTERS}]{{6}}", code) for code in codes)
    assert not set(LETTERS) & set("AEIOUY0125")


@pytest.mark.parametrize("change", [str, str.lower, lambda code: f" {code[:3]}-{code[3:]} "])
def test_a_code_is_taken_as_people_type_it(change: Callable[[str], str]) -> None:
    room = opened_at([0.0])
    room.check(change(room.code))


@pytest.mark.parametrize("text", ["", "BCDFG", "x" * 10_000, "ÄÖÜÄÖÜ", "\ud800"])
def test_anything_else_is_no_code(text: str) -> None:
    with pytest.raises(EntryError, match="not valid"):
        opened_at([0.0]).check(text)


def test_a_code_ends_by_itself_with_the_next_one_and_when_the_room_is_closed() -> None:
    now = [0.0]
    room = opened_at(now)
    first = room.code
    now[0] = LASTING - 1.0
    assert (room.code, room.seconds_left) == (first, 1)
    now[0] = LASTING
    assert room.code == ""
    with pytest.raises(EntryError, match="not valid"):
        room.check(first)
    room.open()
    assert room.code != first
    room.close()
    for text in (room.code, first):  # an empty code is none
        with pytest.raises(EntryError, match="not valid"):
            room.check(text)


def test_whoever_guesses_codes_has_a_chance_below_one_in_fifty_thousand() -> None:
    now = [0.0]
    room = opened_at(now)
    tried = 0
    for tenth in range(int(10 * LASTING)):  # ten tries a second, as long as the code is valid
        now[0] = tenth / 10.0
        with pytest.raises(EntryError) as refused:
            room.check("BBBBBB" if room.code != "BBBBBB" else "CCCCCC")
        tried += "not valid" in str(refused.value)
    assert tried == MAX_TRIES * LASTING / 60.0
    assert tried / len(LETTERS) ** 6 < 1 / 50_000


def test_the_code_waits_until_the_guesser_has_to_pause() -> None:
    now = [60.0]
    room = opened_at(now)
    for _ in range(MAX_TRIES):
        with pytest.raises(EntryError, match="not valid"):
            room.check("")
    with pytest.raises(EntryError, match="Try again in a minute"):
        room.check(room.code)
    now[0] = 120.0
    room.check(room.code)


@at_table(people=3)
async def test_whoever_has_the_code_takes_a_free_seat_until_all_are_taken(links: Addresses) -> None:
    async with AsyncExitStack() as stack:
        host = await stack.enter_async_context(page(links.host))
        told = (await host.until("people"))["room"]
        assert (told["code"], told["link"]) == (code_of(links), links.entrance)
        assert 1700 < told["seconds"] <= LASTING
        form = await asyncio.to_thread(httpx.get, links.entrance, trust_env=False)
        assert f'value="{code_of(links)}"' in form.text
        assert "form-action 'self'" in form.headers["Content-Security-Policy"]

        wrong = await enter(links, "BCDFGH")
        assert (wrong.status_code, "This code is not valid" in wrong.text) == (403, True)
        seats = []
        for _ in range(2):
            sent = await enter(links, code_of(links).lower())
            assert sent.status_code == 303
            guest = page(str(sent.url.join(sent.headers["location"])))
            seats.append((await (await stack.enter_async_context(guest)).until("table"))["seat"])
        assert seats == [2, 1]  # the host has sent the first link first
        full = await enter(links, code_of(links))
        assert (full.status_code, "All seats are taken" in full.text) == (409, True)
        refused = await asyncio.to_thread(httpx.get, links.guests[1], trust_env=False)
        assert refused.status_code == 404  # another has the seat

        while (await host.until("people"))["people"][1]["where"] == "expected":
            pass  # it came
        await host.send(kind="free", seat=1)
        while (await host.until("people"))["people"][1]["where"] != "expected":
            pass  # it has gone
        assert (await enter(links, code_of(links))).status_code == 303


@at_table(people=3)
async def test_two_who_come_at_the_same_time_have_two_seats(links: Addresses) -> None:
    answers = await asyncio.gather(*(enter(links, code_of(links)) for _ in range(3)))
    assert sorted(answer.status_code for answer in answers) == [303, 303, 409]
    assert len({answer.headers.get("location") for answer in answers}) == 3


@at_table(people=2)
async def test_the_host_closes_the_room_and_opens_it_with_another_code(
    host: PageClient, links: Addresses
) -> None:
    await host.until("people")
    await host.send(kind="room", open=False)
    assert (await host.until("people"))["room"]["code"] == ""
    assert (await enter(links, code_of(links))).status_code == 403
    await host.send(kind="room", open=True)
    another = (await host.until("people"))["room"]["code"]
    assert (await enter(links, code_of(links))).status_code == 403
    assert (await enter(links, another)).status_code == 303


def test_a_form_of_any_size_is_answered_and_a_table_for_one_has_no_room(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan(people=2), tmp_path) as links:
            assert (await enter(links, "x" * 1_000_000)).status_code == 403
        async with tables_links(small_plan(), tmp_path) as links:
            assert links.entrance == ""
            address = links.host.partition("play/")[0]
            answer = await asyncio.to_thread(httpx.get, f"{address}join", trust_env=False)
            assert answer.status_code == 404

    asyncio.run(play())


@at_table("navigation", 60.0, people=2)
async def test_whoever_comes_late_watches_and_is_sent_to_their_seat_when_the_match_is_over(
    host: PageClient, links: Addresses, monkeypatch: pytest.MonkeyPatch
) -> None:
    matches: list[Match] = []
    begin = Audience.begin
    monkeypatch.setattr(Audience, "begin", lambda self, match: (matches.append(match), begin(self, match)))
    await host.send(kind="start")
    await host.until("moment")
    sent = await enter(links, code_of(links))
    own = str(sent.url.join(sent.headers["location"]))
    async with page(own) as late:
        await late.until("elsewhere")
    async with page(own.replace("/play/", "/watch/")) as watching:
        assert (await watching.until("moment"))["kind"] == "all"
        matches[0].state.matches.frame_limit[0] = 0  # it ends now
        with pytest.raises(ConnectionClosed) as closed:
            await watching.until("never")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == SEATED
    async with page(own) as seated:
        await seated.until("over")
        await host.until("over")
        await host.send(kind="start")
        await seated.until("moment")
        async with page(own.replace("/play/", "/watch/")) as cheating:
            with pytest.raises(ConnectionClosed, match="whoever plays does not watch"):
                await cheating.until("moment")
