"""docs/rules.md tells of combat and supplies what the engine does, number by number."""

import re
from pathlib import Path

import pytest

from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.maps.game_map import SUPPLY_SPACING
from wildscav_engine.rules import Rules
from wildscav_engine.set_up import SPARE_SLOTS
from wildscav_engine.spec import SupplyConfig, SupplyWave
from wildscav_engine.systems.damage import RESPAWN_DISTANCE

PAGE = (Path(__file__).parents[2] / "docs" / "rules.md").read_text("utf-8").partition("## Combat")[2]
ROW = re.compile(r"^\| (?P<rule>[^|]+) \| (?P<value>[^|]+) \| (?P<unit>[^|]*)\| (?P<where>[^|]+) \|$", re.M)
ROWS = {row["rule"]: row for row in ROW.finditer(PAGE) if row["rule"] != "rule"}
HOLDERS = {"Rules": Rules(), "SupplyConfig": SupplyConfig(), "SupplyWave": SupplyWave()}
CONSTANTS = {
    "height of the body": BODY_HEIGHT,
    "radius of the body": BODY_RADIUS,
    "height of the eye": EYE_HEIGHT,
    "distance kept from the living at a return": RESPAWN_DISTANCE,
    "distance of places indoors": SUPPLY_SPACING,
}


def shown(value: float | tuple[int, int]) -> str:
    return "–".join(map(str, value)) if isinstance(value, tuple) else f"{value:g}"


@pytest.mark.parametrize("rule", [rule for rule, row in ROWS.items() if row["where"] != "constant"])
def test_every_rule_that_can_be_changed_is_told_with_its_default(rule: str) -> None:
    row = ROWS[rule]
    holder, field = row["where"].strip("`").split(".")
    assert row["value"] == shown(getattr(HOLDERS[holder], field))


@pytest.mark.parametrize("rule", CONSTANTS)
def test_every_constant_is_told_as_it_is(rule: str) -> None:
    assert ROWS[rule]["where"] == "constant"
    assert ROWS[rule]["value"] == shown(CONSTANTS[rule])


@pytest.mark.parametrize("section", ["start_health", "shot_damage", "supply_loss", "pick_up_distance"])
def test_rules_of_combat_and_supplies_are_all_told(section: str) -> None:
    assert f"`Rules.{section}`" in PAGE


def test_the_text_agrees_with_the_tables() -> None:
    assert SPARE_SLOTS == 4
    assert "with four more than the waves need for each seat" in PAGE
