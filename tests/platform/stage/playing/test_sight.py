"""What a person's page is told: what the seat sees, and nothing else."""

import asyncio
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import small_plan, tables_links

from wildscav_engine.maps import generate_map
from wildscav_engine.record import Record, read_record, resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.visibility import BOX_TOP, Eye, sees_body, sees_point
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import NAMED, Senses
from wildscav_stage.playing.lobby import Person
from wildscav_stage.playing.plan import Plan
from wildscav_stage.playing.sight import Known, Sight

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


def two_in_the_open(rules: str = "original") -> Match:
    """Return a match of two people; the second one is 8 m to the north, and both look there."""
    spec = small_plan("battle", 60.0, people=2).spec
    match = Match(spec.model_copy(update={"rules": NAMED[rules]}))
    agents = match.state.agents
    agents.yaw[0], agents.pitch[0], agents.invincible_left[0] = 0.0, 0.0, 0
    for place in match.game_map.outdoor:
        agents.position[0] = place, np.add(place, (0.0, 0.0, 8.0))
        if abs(place[2]) < 15.0 and "others" in Sight(match, 0).message(Known()):
            return match
    raise LookupError("there is no such place")


def shooting(seat: int) -> NDArray[np.float32]:
    """Return actions of two seats in which one shoots."""
    actions = np.zeros((2, len(Field)), np.float32)
    actions[seat, Field.SHOOT] = 1.0
    return actions


def shoot(match: Match, seat: int, frames: int, sight: Sight) -> None:
    """Let a seat shoot at the ground before it, the shots near each other, and note it."""
    agents, actions = match.state.agents, shooting(seat)
    for frame in range(frames):
        agents.yaw[0, seat], agents.pitch[0, seat] = frame % 31 - 15.0, 15.0 + frame % 17
        match.step(actions)
        sight.note()


def test_of_a_shot_that_is_seen_the_page_is_told_from_where_and_to_where() -> None:
    match = two_in_the_open()
    sight = Sight(match, 0)
    shoot(match, 1, 200, sight)
    shots = sight.message(Known())["shots"]
    soles = np.rint(100 * match.state.agents.position[0, 1]).tolist()
    assert len(shots) == 15  # all that were in the clip
    assert all(shot[:4] == [1, *soles] and len(shot) == 7 for shot in shots)

    match.state.agents.fired[0, 1] = True
    match.state.agents.shot_end[0, 1, 1] -= 0.01  # m: rounding may put an end below the surface
    sight.note()
    assert len(sight.message(Known())["shots"][0]) == 7

    match.state.agents.yaw[0, 0] = 180.0
    shoot(match, 1, 20, sight)
    assert "shots" not in sight.message(Known())


def test_of_ones_own_shots_all_ends_are_told() -> None:
    match = two_in_the_open()
    sight = Sight(match, 0)
    shoot(match, 0, 100, sight)
    match.state.agents.fired[0, 0], match.state.agents.yaw[0, 0] = True, 180.0  # so that the end is behind
    sight.note()
    shots = sight.message(Known())["shots"]
    assert len(shots) > 8
    assert all(len(shot) == 7 for shot in shots)


@pytest.mark.parametrize(
    ("rules", "yaw", "health", "told"),
    [
        ("original", 180.0, 100, {"hurt"}),  # from behind: by whom, and nothing else
        ("original", 180.0, 20, {"hurt", "deaths"}),  # nor from where, for those who die of it
        ("original", 0.0, 20, {"hurt", "deaths", "killer", "others", "shots"}),
        ("fair", 0.0, 20, {"hurt", "deaths", "killer", "others", "shots"}),
    ],
)
def test_who_is_shot_is_told_of_a_killer_in_sight_where_it_stood_and_its_health_if_agents_are(
    rules: str, yaw: float, health: int, told: set[str]
) -> None:
    match = two_in_the_open(rules)
    agents, sight = match.state.agents, Sight(match, 0)
    agents.yaw[0], agents.health[0] = (yaw, 180.0), (health, 70)
    match.step(shooting(1))
    sight.note()
    message = sight.message(Known())
    happened = {"shots", "others", "hurt", "deaths", "killer"} & message.keys()
    assert happened - {"others", "shots"} == told - {"others", "shots"}
    assert happened <= told
    assert message["hurt"] == [1]
    if "deaths" in told:
        assert message["deaths"] == [[0, 1]]
    if "killer" in told:
        place = np.rint(100 * agents.position[0, 1]).tolist()
        assert message["killer"] == [1, *place, *([70] if rules == "original" else [])]


def test_of_others_only_their_invincibility_is_told() -> None:
    match = two_in_the_open()
    for left in (0, 9):
        match.state.agents.invincible_left[0, 1] = left
        (row,) = Sight(match, 0).message(Known())["others"]
        assert (len(row), row[-1]) == (6, left > 0)


@pytest.mark.parametrize("rules", ["original", "fair"])
def test_boxes_are_told_at_any_distance_and_behind_walls_if_the_rules_say_so(rules: str) -> None:
    match = Match(small_plan("gathering").spec.model_copy(update={"rules": NAMED[rules]}))
    agents, told = match.state.agents, []
    for yaw in range(0, 360, 45):
        agents.yaw[0, 0] = yaw
        match.step()
        place, pitch = agents.position[0, 0], float(agents.pitch[0, 0])
        eye = Eye(place[0], place[1] + EYE_HEIGHT, place[2], float(yaw), pitch, match.spec.rules.view_angle)
        for _, x, y, z in Sight(match, 0).message(Known()).get("boxes", []):
            box = 0.01 * np.array([x, y, z])
            seen = sees_point(match.game_map.world, eye, box[0], box[1] + BOX_TOP, box[2])
            told.append((seen, float(np.linalg.norm(box - place))))
    near = match.spec.rules.supply_sight
    assert any(seen and distance > near for seen, distance in told)
    hidden = [distance for seen, distance in told if not seen]
    assert bool(hidden) == (rules == "original")
    assert all(distance < near + 0.1 for distance in hidden)


def test_a_target_is_told_once_it_is_known() -> None:
    match = Match(small_plan().spec)
    sight, known = Sight(match, 0), Known()
    told = []
    for knows in (False, True, True):
        match.state.agents.knows_target[0, 0] = knows
        told.append("target" in sight.message(known))
    assert told == [False, True, False]


def test_a_page_that_comes_later_is_told_of_known_boxes_and_of_no_past() -> None:
    def started() -> tuple[Match, Sight]:
        match = Match(small_plan("gathering").spec)
        return match, Sight(match, 0)

    async def play() -> None:
        person = Person()
        match, person._sight = started()
        boxes = (await person.look(known := Known()))["boxes"]
        for _ in range(3):
            match.step()
            assert not person._sight.has_news_for(known)  # the frame was not noted
            match.state.agents.fired[0, 0] = True
            match.state.agents.yaw[0, 0] += 120.0
            person._sight.note()
            boxes += (await person.look(known)).get("boxes", []) if person._sight.has_news_for(known) else []
        later = await person.look(Known())
        assert sorted(later["boxes"]) == sorted(boxes)
        assert "shots" not in later

        _, person._sight = started()
        assert (await person.look(known))["frame"] == 0
        assert known.boxes

    asyncio.run(play())
