"""What people are given of the matches that they have played."""

import asyncio
from pathlib import Path
from typing import Any

import httpx
import pytest
from tests.platform.stage.playing.pages import page
from tests.platform.stage.playing.tables import small_plan, tables_links

from wildscav_engine.record import read_record, verify_record


async def ask(address: str) -> httpx.Response:
    return await asyncio.to_thread(httpx.get, address, trust_env=False)


async def played(links: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Play a match, and return what the host and the guest are told of its end."""
    async with page(links.host) as host, page(links.guests[0]) as guest:
        await guest.until("people")
        await host.send(kind="start")
        ends = await asyncio.gather(host.until("over"), guest.until("over"))
        return ends[0], ends[1]


@pytest.mark.usefixtures("viewer")
def test_everybody_who_has_a_link_watches_the_match_and_takes_its_record(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan("navigation", 0.5, people=2), tmp_path) as links:
            hosts, guests = await played(links)
            assert hosts["match"] == guests["match"] == {"number": 0, "record": Path(hosts["record"]).name}
            assert guests["played"] == [0, 1]
            for link in (links.host, links.guests[0], links.watch):
                shown = await ask(f"{link}/matches/0")
                assert 'data-map="0/map" data-trails="0/trails"' in shown.text
                assert 'src="../../../stage/viewer.js?v=' in shown.text
                assert (await ask(str(shown.url.join("../../../stage/viewer.js")))).status_code == 200
                assert (await ask(str(shown.url.join("../../../static/match.css")))).status_code == 200
            trails = (await ask(f"{links.guests[0]}/matches/0/trails")).json()
            assert [seat["name"] for seat in trails["seats"]] == ["person 1", "person 2"]
            assert (await ask(f"{links.guests[0]}/matches/0/map")).content
            record = await ask(f"{links.guests[0]}/matches/0/record")
            assert record.headers["content-disposition"].startswith("attachment; ")
            (tmp_path / "taken.wsr").write_bytes(record.content)
            assert verify_record(read_record(tmp_path / "taken.wsr")).holds

    asyncio.run(play())


def test_nobody_else_is_given_anything(tmp_path: Path) -> None:
    async def play() -> None:
        async with tables_links(small_plan("navigation", 0.5, people=2), tmp_path) as links:
            await played(links)
            for address in (
                f"{links.host}x/matches/0",
                f"{links.host}x/matches/0/record",
                f"{links.host}/matches/1",
                f"{links.host}/matches/0/spec",
                f"{links.host}/matches/-1/record",
            ):
                assert (await ask(address)).status_code == 404, address

    asyncio.run(play())
