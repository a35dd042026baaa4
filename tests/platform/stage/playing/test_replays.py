"""What people are given of the matches that they have played."""

import asyncio
import time
from pathlib import Path
from typing import Any

import httpx
import pytest
from tests.platform.stage.playing.pages import page
from tests.platform.stage.playing.tables import at_table

from wildscav_engine.record import read_record, verify_record
from wildscav_stage.playing.links import Addresses


async def ask(address: str) -> httpx.Response:
    """Ask as pages do: again while it is being made."""

    def patiently() -> httpx.Response:
        while (answer := httpx.get(address, trust_env=False)).status_code == 202:
            time.sleep(0.05)
        return answer

    return await asyncio.to_thread(patiently)


def address_of(links: Addresses, over: dict[str, Any]) -> str:
    return f"{links.host.partition('play/')[0]}matches/{over['match']['secret']}"


async def played(links: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Play a match, and return what the host and the guest are told of its end."""
    async with page(links.host) as host, page(links.guests[0]) as guest:
        await guest.until("people")
        await host.send(kind="start")
        ends = await asyncio.gather(host.until("over"), guest.until("over"))
        return ends[0], ends[1]


@pytest.mark.usefixtures("viewer")
@at_table("navigation", 0.5, people=2)
async def test_everybody_who_is_told_of_its_end_watches_the_match_and_takes_its_record(
    links: Addresses, tmp_path: Path
) -> None:
    hosts, guests = await played(links)
    assert hosts["match"] == guests["match"]
    assert hosts["match"]["record"] == Path(hosts["record"]).name
    assert guests["played"] == [0, 1]
    address, secret = address_of(links, hosts), hosts["match"]["secret"]
    shown = await ask(address)
    assert f'data-map="{secret}/map" data-trails="{secret}/trails"' in shown.text
    assert 'src="../stage/viewer.js?v=' in shown.text
    assert (await ask(str(shown.url.join("../stage/viewer.js")))).status_code == 200
    assert (await ask(str(shown.url.join("../static/match.css")))).status_code == 200
    trails = (await ask(f"{address}/trails")).json()
    assert [seat["name"] for seat in trails["seats"]] == ["person 1", "person 2"]
    assert (await ask(f"{address}/map")).content
    record = await ask(f"{address}/record")
    assert record.headers["content-disposition"].startswith("attachment; ")
    (tmp_path / "taken.wsr").write_bytes(record.content)
    assert verify_record(read_record(tmp_path / "taken.wsr")).holds


@at_table("navigation", 0.5, people=2)
async def test_nobody_else_is_given_anything(links: Addresses) -> None:
    address = address_of(links, (await played(links))[0])
    seat = links.host.rpartition("/")[2]  # whoever passes the link on gives their seat to nobody
    assert seat not in address
    for other in (
        f"{address}x",
        f"{address}x/record",
        f"{address}/spec",
        address.rpartition("/")[0] + f"/{seat}",
    ):
        refused = await ask(other)
        assert (refused.status_code, "There is nothing here" in refused.text) == (404, True), other


@pytest.mark.usefixtures("viewer")
@at_table("navigation", 0.5, people=2)
async def test_guests_are_not_told_where_a_record_lies_that_cannot_be_read(
    links: Addresses, tmp_path: Path
) -> None:
    over, _ = await played(links)
    await asyncio.to_thread(Path(over["record"]).write_bytes, b"no record")
    for name in ("", "/trails"):
        refused = await ask(f"{address_of(links, over)}{name}")
        assert refused.status_code == 500
        assert "cannot be read" in refused.text
        assert str(tmp_path) not in refused.text
