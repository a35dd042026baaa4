"""docs/rules.md tells of the game what the engine does, number by number."""

import re
from pathlib import Path

import pytest

from wildscav_engine.maps.game_map import SUPPLY_SPACING
from wildscav_engine.simulation.robots.decide import KINDS
from wildscav_engine.simulation.robots.skill import EASY, HARD, NORMAL, Skill
from wildscav_engine.simulation.setup.drawn_starts import START_DISTANCE, TARGET_DISTANCE
from wildscav_engine.simulation.setup.match_setup import SPARE_SLOTS
from wildscav_engine.simulation.systems.damage import RESPAWN_DISTANCE
from wildscav_engine.simulation.systems.visibility import AGENT_LIMIT, ASPECT, SUPPLY_LIMIT
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, NAMED, Rules, Senses
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave
from wildscav_engine.tracks import TRACKS
from wildscav_engine.tracks.royale import DAMAGES, SHARES, SHRINK, WAIT

PAGE = (Path(__file__).parents[2] / "docs" / "rules.md").read_text("utf-8").partition("## Combat")[2]
ROW = re.compile(
    r"^\| (?P<rule>[^|]+) \| (?P<value>[^| ]+?)°?(?: [^|]+)? \| (?P<where>constant|`\w+\.\w+`) \|$", re.M
)
ROWS = {row["rule"]: row for row in ROW.finditer(PAGE)}
HOLDERS = {
    "MatchSpec": MatchSpec(track="battle"),
    "Rules": Rules(),
    "SupplyConfig": SupplyConfig(),
    "SupplyWave": SupplyWave(),
}
CONSTANTS = {
    "distance from living agents at a respawn": RESPAWN_DISTANCE,
    "distance between places indoors": SUPPLY_SPACING,
    "frames in a second of game time": FRAMES_PER_SECOND,
    "least distance between two starts, where there is room": START_DISTANCE,
    "least distance from start to target, where there is room": TARGET_DISTANCE,
    "height of that view, as a share of its width": ASPECT,
    "most agents listed, nearest first": AGENT_LIMIT,
    "most boxes listed, nearest first": SUPPLY_LIMIT,
}


def shown(value: float | tuple[int, int]) -> str:
    return "–".join(map(str, value)) if isinstance(value, tuple) else f"{value:g}"


@pytest.mark.parametrize("rule", [rule for rule, row in ROWS.items() if row["where"] != "constant"])
def test_every_rule_that_can_be_changed_is_told_with_its_default(rule: str) -> None:
    row = ROWS[rule]
    holder, field = row["where"].strip("`").split(".")
    value = getattr(HOLDERS[holder], field)
    assert row["value"] == (Senses(value).name.lower() if field == "senses" else shown(value))


@pytest.mark.parametrize("rule", CONSTANTS)
def test_every_constant_is_told_as_it_is(rule: str) -> None:
    assert ROWS[rule]["where"] == "constant"
    assert ROWS[rule]["value"] == shown(CONSTANTS[rule])


def test_the_fair_rules_are_told() -> None:
    told = re.findall(
        r"^\| ((?:`\w+`(?:, )?)+) \| (\w[\w.]*)[^|]* \|$", PAGE.partition("### Fair rules")[2], re.M
    )
    numbers = {name: value for names, value in told for name in re.findall(r"`(\w+)`", names)}
    rules = NAMED["fair"]
    changed = {name: value for name, value in rules._asdict().items() if value != getattr(Rules(), name)}
    changed["senses"] = Senses(rules.senses).name.lower()
    assert {name: numbers[name] for name in changed} == {
        name: value if name == "senses" else shown(value) for name, value in changed.items()
    }


@pytest.mark.parametrize("section", ["start_health", "shot_damage", "supply_loss", "pick_up_distance"])
def test_rules_of_combat_and_supplies_are_all_told(section: str) -> None:
    assert f"`Rules.{section}`" in PAGE


def test_the_text_agrees_with_the_tables() -> None:
    assert SPARE_SLOTS == 4
    text = " ".join(PAGE.split())
    rules = Rules()
    assert rules.spread == rules.recoil == rules.walking_sway == rules.turning_sway == 0
    assert "By default, all four are 0." in text
    assert "room for the boxes of its waves and four more for each seat" in text
    spot = HotSpot()
    boxes = (
        f"{spot.boxes} boxes of {spot.quantity[0]} to {spot.quantity[1]} supplies and r = {spot.radius:g} m"
    )
    assert f"visits {spot.places} places for {spot.interval:g} s each, with {boxes}" in text


@pytest.mark.parametrize("name", TRACKS)
def test_every_track_is_told(name: str) -> None:
    assert len(re.findall(rf"^\| `{name}` ", PAGE, re.M)) == 1


def test_every_phase_of_the_zone_is_told() -> None:
    text = " ".join(PAGE.split())
    assert f"each phase waits for {WAIT:g} of the time limit and shrinks for {SHRINK:g} of it" in text
    rows = "".join(
        f"| {phase} | {share:g} | {damage:g} |\n"
        for phase, (share, damage) in enumerate(zip(SHARES, DAMAGES, strict=True), 1)
    )
    assert f"|---|---|---|\n{rows}\n" in PAGE


@pytest.mark.parametrize(("level", "skill"), [("easy", EASY), ("normal", NORMAL), ("hard", HARD)])
def test_every_level_of_robots_is_told(level: str, skill: Skill) -> None:
    numbers = (skill.wander_speed, skill.speed, skill.turn_limit, skill.aim_error)
    assert f"| {level} | {' | '.join(f'{number:g}' for number in numbers)} |" in PAGE


def test_every_robot_is_told() -> None:
    told = set(re.findall(r"^\| `([\w-]+)` \| ([^|`]+) \|$", PAGE, re.M))
    assert {(normal.name, normal.title) for _, normal, _ in KINDS.values()} <= told
