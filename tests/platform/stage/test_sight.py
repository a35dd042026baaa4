"""What a person's page is told: what the seat sees, and nothing else."""

import asyncio
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.platform.stage.pages import PageClient, page
from tests.platform.stage.tables import small_plan, tables_links

from wildscav_engine.maps import generate_map
from wildscav_engine.record import Record, read_record, resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.visibility import Eye, sees_body
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import NAMED, Senses
from wildscav_stage.plan import Plan
from wildscav_stage.sight import Known, Sight

EVERYWHERE = 360.0  # degrees, of view
MOST = 20_000  # bytes a second down, of a battle of ten


def play_out(plan: Plan, folder: Path) -> tuple[Record, list[PageClient]]:
    """Play a match in which all people walk ahead, and return its record and what their pages were told."""

    async def play() -> tuple[Path, list[PageClient]]:
        async with tables_links(plan, folder) as links, page(links.host) as host:
            clients = [host]
            if plan.people > 1:
                async with page(links.guests[0]) as guest:
                    await host.send(kind="start")
                    over, _ = await asyncio.gather(host.until("over"), guest.until("over"))
                clients.append(guest)
            else:
                await host.send(kind="start")
                await host.send(kind="input", number=1, forward=1.0)
                over = await host.until("over")
            return Path(over["record"]), clients

    path, clients = asyncio.run(play())
    return read_record(path), clients


def numbers(client: PageClient) -> set[int]:
    return {int(number) for text in client.texts for number in re.findall(r"-?\d+", text)}


def test_an_enemy_behind_a_wall_is_in_no_message(tmp_path: Path) -> None:
    plan = small_plan("battle", 1.0, people=2)
    game_map = generate_map(plan.spec.map.config, plan.spec.map.seed)
    here, there = next(
        (a, b)
        for a in game_map.outdoor[::37]
        for b in game_map.outdoor[::41]
        if min(abs(b[0]), abs(b[2])) > 4.0
        and not sees_body(game_map.world, Eye(a[0], a[1] + EYE_HEIGHT, a[2], 0.0, 0.0, EVERYWHERE), *b)
    )
    # Odd places, so that no other number is the same by chance.
    starts = tuple(tuple(place + offset) for place, offset in ((here, 0.0137), (there, 0.0237)))
    spec = plan.spec.model_copy(update={"starts": starts})
    record, (host, guest) = play_out(replace(plan, spec=spec), tmp_path)
    place = [round(100 * part) for part in (starts[1][0], starts[1][2])]
    assert not any("others" in text for text in host.texts)
    assert set(place) <= numbers(guest)
    assert not set(place) & numbers(host)
    assert record.steps == 50


@pytest.mark.parametrize("rules", ["original", "fair"])
def test_others_are_told_of_while_they_are_in_sight(tmp_path: Path, rules: str) -> None:
    plan = small_plan("battle", 4.0, ("fighter",) * 9)
    plan = replace(plan, spec=plan.spec.model_copy(update={"rules": NAMED[rules]}))
    record, (host,) = play_out(plan, tmp_path)
    told = [message for message in map(json.loads, host.texts) if message["kind"] == "now"]
    by_frame = {message["frame"]: message for message in told}
    deaths, met = 0, 0
    for match in resimulate(record):
        deaths = int(match.state.agents.deaths.sum())
        if (message := by_frame.get(match.frame)) is not None:
            seen = match.seen.agents[0, 0, : match.seen.agent_count[0, 0]]
            others = message.get("others", [])
            assert sorted(row[0] for row in others) == sorted(seen.tolist())
            for seat, *place, _, _ in others:
                assert place[:3] == np.rint(100 * match.state.agents.position[0, seat]).tolist()
            met += len(others)
    assert met > 50
    assert len(by_frame) > 60  # of 100
    assert len([death for message in told for death in message.get("deaths", [])]) in (deaths, deaths - 1)
    assert sum(map(len, host.texts)) / 4.0 < MOST


def test_a_person_sees_with_eyes_what_agents_are_told_by_pictures_alone() -> None:
    plan = small_plan("battle", 2.0, ("fighter",) * 5)
    told = []
    for senses in (Senses.PIXELS, Senses.SIGHTED):
        rules = plan.spec.rules._replace(senses=int(senses))
        match = Match(plan.spec.model_copy(update={"rules": rules}))
        sight, known = Sight(match, 0), Known()
        messages = []
        for _ in range(20):
            match.step()
            sight.note()
            messages.append(sight.message(known))
        told.append(messages)
    assert told[0] == told[1]


def test_a_box_that_is_taken_out_of_sight_stays_where_it_was_seen() -> None:
    spec = small_plan("gathering", 60.0).spec
    match = Match(spec.model_copy(update={"rules": NAMED["fair"]}))
    sight, agents, supplies = Sight(match, 0), match.state.agents, match.state.supplies
    for yaw in range(0, 360, 30):
        agents.yaw[0, 0], known = yaw, Known()
        if boxes := sight.message(known).get("boxes"):
            break
    ((serial, *_), *_) = boxes
    supplies.quantity[0, supplies.serial[0] == serial] = 0
    agents.yaw[0, 0] += 180.0
    assert "gone" not in sight.message(known)
    agents.yaw[0, 0] -= 180.0
    assert sight.message(known)["gone"] == [serial]
