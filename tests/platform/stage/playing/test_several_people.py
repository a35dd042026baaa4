"""Matches of several people, each with a page of their own, at a real table."""

import asyncio
from pathlib import Path

import httpx
import pytest
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import at_table, small_plan
from websockets.exceptions import ConnectionClosed, InvalidStatus

from wildscav_engine.record import read_record, verify_record
from wildscav_server.match_server import MatchServer
from wildscav_stage.playing.links import Addresses, Base, Links
from wildscav_stage.playing.lobby import HOST
from wildscav_stage.playing.page import RENEWED
from wildscav_stage.playing.rounds import MatchHosting
from wildscav_stage.playing.site.app import MAX_COMMANDS
from wildscav_stage.playing.table import Table


async def everybody(client: PageClient, *where: str) -> list[str]:
    """Read until everybody is where they are expected to be, and return their names."""
    while True:
        people = (await client.until("people"))["people"]
        if [person["where"] for person in people] == list(where):
            return [person["name"] for person in people]


@at_table("navigation", 1.2, people=2)
async def test_two_people_play_each_other_and_the_match_is_recorded(
    host: PageClient, links: Addresses
) -> None:
    assert await everybody(host, "here", "expected") == ["person 1", "person 2"]
    async with page(links.guests[0]) as guest:
        await guest.send(kind="rename", name="Ada")
        while await everybody(host, "here", "here") != ["person 1", "Ada"]:
            pass
        await host.send(kind="start")
        await asyncio.gather(host.until("moment"), guest.until("moment"))
        await host.send(kind="input", number=1, forward=1.0)
        await guest.send(kind="input", number=1, turn=45.0)
        ends = await asyncio.gather(host.until("over"), guest.until("over"))
        assert host.shown["own"] != guest.shown["own"]
        hosts, guests = ends
        assert hosts["rows"] == guests["rows"]
        assert "record" not in guests  # where files lie is the host's business
        record = read_record(Path(str(hosts["record"])))
        assert record.names == ("person 1", "Ada")
        assert verify_record(record).holds
        assert (record.actions[:, 0, 1] == 10.0).any()
        assert not record.actions[:, 1, 1].any()
        assert (record.actions[:, 1, 2] == 45.0).sum() == 1


@at_table("navigation", 2.2, people=2)
async def test_a_seat_stands_idle_until_its_person_is_back(host: PageClient, links: Addresses) -> None:
    async with page(links.guests[0]) as guest:
        await everybody(host, "here", "here")
        await host.send(kind="start")
        await guest.until("moment")
        await guest.send(kind="input", number=1, forward=1.0)
        while guest.shown["input"] < 1:
            await guest.until("moment")
    await everybody(host, "here", "away")
    before = (await host.until("moment"))["frame"]
    while host.shown["frame"] < before + 25:
        await host.until("moment")  # the match waits for nobody
    async with page(links.guests[0]) as guest:
        await guest.until("begin")
        await everybody(host, "here", "here")
        await guest.until("moment")
        await guest.send(kind="input", number=2, forward=-1.0)
        record = read_record(Path((await host.until("over"))["record"]))
    walking = [bool(speed) for speed in record.actions[:, 1, 1]]
    changes = [now for before, now in zip([False, *walking], walking, strict=False) if now != before]
    assert changes == [True, False, True]
    assert verify_record(record).holds


@at_table("navigation", 0.7, people=2)
async def test_a_robot_plays_for_whoever_comes_too_late(host: PageClient, links: Addresses) -> None:
    await host.send(kind="start")
    await host.until("moment")
    async with page(links.guests[0]) as guest:
        await guest.until("elsewhere")
        over, _ = await asyncio.gather(host.until("over"), guest.until("over"))
        assert guest.moments == 0
        assert read_record(Path(over["record"])).names == ("person 1", "seeker-easy")
        await host.send(kind="start")  # they play again
        await guest.until("begin")


@at_table(people=3)
async def test_only_the_host_decides(host: PageClient, guest: PageClient, links: Addresses) -> None:
    shown = await host.until("people")
    assert shown["links"] == {"1": links.guests[0], "2": links.guests[1]}
    assert "links" not in await guest.until("people")
    await guest.send(kind="start")
    assert (await guest.until("refused"))["message"] == "only the host starts matches"
    await guest.send(kind="free", seat=2)
    assert (await guest.until("refused"))["message"] == "only the host frees seats"
    await guest.send(kind="room", open=True)
    assert (await guest.until("refused"))["message"] == "only the host opens and closes the room"
    await guest.send(kind="arrange", robots=[], new_map=True)
    assert (await guest.until("refused"))["message"] == "only the host chooses what is played"
    await host.send(kind="free", seat=0)
    assert (await host.until("refused"))["message"] == "seat 0 is no guest's"
    await host.send(kind="arrange", robots=["gost"], new_map=False)
    assert (await host.until("refused"))["message"].startswith("there is no robot 'gost'")
    await guest.send(kind="rename", name="person 1")
    assert (await guest.until("refused"))["message"].startswith("somebody else is called person 1")


@at_table("battle", 60.0, people=2)
async def test_a_match_of_several_people_is_not_paused(host: PageClient, guest: PageClient) -> None:
    assert not (await host.until("table"))["may_pause"]
    await everybody(host, "here", "here")
    await host.send(kind="start")
    await host.until("moment")
    await guest.send(kind="pause", paused=True)
    await host.send(kind="pause", paused=True)
    frame = (await host.until("moment"))["frame"]
    while host.shown["frame"] < frame + 25:
        await host.until("moment")


@at_table(people=2)
async def test_a_seat_that_is_freed_has_another_link_for_the_host_to_send_and_the_old_one_ends(
    host: PageClient, guest: PageClient, links: Addresses
) -> None:
    def ask(link: str) -> str:
        refused = httpx.get(link, trust_env=False)
        assert refused.status_code == 404
        return refused.text

    await everybody(host, "here", "here")
    await host.send(kind="free", seat=1)
    with pytest.raises(ConnectionClosed) as closed:
        await guest.until("over")
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == RENEWED
    told = await host.until("people")
    while told["people"][1]["where"] != "expected":
        told = await host.until("people")
    async with page(told["links"]["1"]):
        await everybody(host, "here", "here")
    explained = await asyncio.to_thread(ask, links.guests[0])
    assert "Ask the host for another link" in explained
    assert "ask whoever invited you" in await asyncio.to_thread(ask, f"{links.host}x")
    root = links.host.partition("play/")[0]
    assert "open the whole link" in await asyncio.to_thread(ask, f"{root}elsewhere")


@at_table(people=2)
async def test_a_flood_of_what_everybody_is_told_is_closed(host: PageClient, guest: PageClient) -> None:
    for number in range(2 * MAX_COMMANDS + 1):
        await guest.send(kind="rename", name=f"guest {number}")
    with pytest.raises(ConnectionClosed, match="too many messages"):
        await guest.until("over")
    await everybody(host, "here", "away")


@at_table(people=2, public_url="https://play.example.org/")
async def test_pages_behind_a_proxy_are_this_sites_own(links: Addresses) -> None:
    assert links.guests[0].startswith("https://play.example.org/")
    async with page(links.host, origin="https://play.example.org") as host:
        shown = await host.until("people")
        assert shown["links"] == {"1": links.guests[0]}
        assert not shown["local_only"]
    with pytest.raises(InvalidStatus, match="403"):
        async with page(links.host, origin="https://elsewhere.example.org"):
            pass


@at_table(people=2, countdown=1)
async def test_a_match_of_several_people_is_counted_down(host: PageClient, guest: PageClient) -> None:
    await everybody(host, "here", "here")
    await host.send(kind="start")
    for client in (host, guest):
        assert (await client.until("countdown"))["seconds"] == 1
        assert (await client.until("moment"))["frame"] < 25


@at_table("navigation", 0.6, people=3)
async def test_everybody_who_is_ready_plays_on_without_the_host(
    guest: PageClient, second_guest: PageClient, links: Addresses, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_stage.playing.lobby.HOST_RETURNS", 0.2)
    async with page(links.host) as host:
        await everybody(host, "here", "here", "here")
        await guest.send(kind="ready", ready=True)
        await second_guest.send(kind="ready", ready=True)
        while not all(person["ready"] for person in (await host.until("people"))["people"][1:]):
            pass
        assert (await host.moments_within(0.3)) == 0  # the host decides while they are here
        await host.send(kind="start")
        await asyncio.gather(guest.until("moment"), second_guest.until("moment"))
    await asyncio.gather(guest.until("over"), second_guest.until("over"))  # which the host does not end
    await guest.send(kind="ready", ready=True)
    assert (await guest.until("people"))["people"][1]["ready"]
    await second_guest.send(kind="ready", ready=True)
    assert (await second_guest.until("begin"))["seats"][0]["name"] == "seeker-easy"  # in the host's seat


@at_table(people=2)
async def test_guests_who_are_ready_wait_for_a_host_who_loads_the_page_again(
    guest: PageClient, links: Addresses
) -> None:
    async with page(links.host):
        await guest.send(kind="ready", ready=True)
        await everybody(guest, "here", "here")
    await everybody(guest, "away", "here")
    async with page(links.host) as host:
        await everybody(guest, "here", "here")
        await host.send(kind="start")
        seats = (await guest.until("begin"))["seats"]
        assert [seat["name"] for seat in seats] == ["person 1", "person 2"]


def test_who_wants_the_next_match_while_the_last_one_leaves_has_it(tmp_path: Path) -> None:
    class Leaving(Table):
        """Each match ends at once, but takes until ``left`` to leave."""

        async def _play(self) -> None:
            begun.append(self.lobby.begin())
            self._change({"kind": "over"})
            await left.wait()

    begun, left = [], asyncio.Event()

    async def play() -> None:
        plan = small_plan(people=2)
        links, hosting = Links(2), MatchHosting(MatchServer(), "", {}, tmp_path)
        table = Leaving(plan, hosting, links, Base("http://a/", "http://a/"), print)
        table.start(HOST)
        table.start(HOST)  # a second click is no second match
        await asyncio.sleep(0)
        assert len(begun) == 1
        table.start(HOST)
        left.set()
        await asyncio.sleep(0.01)
        assert len(begun) == 2
        await table.close()

    asyncio.run(play())


@at_table(people=2)
async def test_whoever_watches_by_a_seat_that_is_freed_has_to_go(host: PageClient, links: Addresses) -> None:
    await host.send(kind="start")
    await host.until("moment")
    async with page(links.guests[0].replace("/play/", "/watch/")) as late:
        await late.until("begin")
        await host.send(kind="free", seat=1)
        with pytest.raises(ConnectionClosed) as closed:
            await late.until("over")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == RENEWED


@at_table("battle", 0.5, ("fighter-easy",), people=2)
async def test_the_host_chooses_the_robots_and_another_map_for_the_next_match(host: PageClient) -> None:
    records = []
    for new_map in (False, True, False):
        robots = ["walker", "gatherer"] if new_map else ["fighter"]
        await host.send(kind="arrange", robots=robots, new_map=new_map)
        told = await host.until("people")
        while told["robots"] != robots:
            told = await host.until("people")
        assert (told["opponents"], told["new_map"]) == (robots, new_map)
        await host.send(kind="start")
        records.append(Path((await host.until("over"))["record"]))
    first, second, third = [read_record(path) for path in records]
    assert (first.names[2:], second.names[2:]) == (("fighter",), ("walker", "gatherer"))
    assert [one.spec.map.seed for one in (first, second, third)] == [5, 6, 6]  # it stays until the host asks
    assert second.spec.map.config == first.spec.map.config
