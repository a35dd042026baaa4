"""Invalid specs are refused, in one line that says what is allowed."""

from typing import Any

import pytest
from pydantic import ValidationError

from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import NAMED, Rules, Senses
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.validation import one_line


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        (
            {"track": "racing"},
            "track is 'racing'; the tracks are navigation, gathering, capture, battle",
        ),
        ({"seats": ["wizard"]}, "seat 0 is filled by 'wizard'; allowed are submission"),
        ({"seats": []}, "seats"),
        ({"target": [0, 0, 0]}, "target is given, but battle has no target"),
        ({"track": "navigation", "supplies": {}}, "supplies is given, but navigation has no supplies"),
        ({"time_limit": 0}, "time_limit: Input should be greater than 0, not 0"),
        ({"seed": -1}, "seed"),
        ({"rules": {"gravity": 1}}, "no rule is called gravity"),
        ({"rules": {"supply_loss": 2}}, "supply_loss"),
        ({"rules": "unfair"}, "no rules are called 'unfair'; allowed are original, fair"),
        ({"rules": {"senses": "sixth"}}, "'sixth' are no senses; the senses are original"),
        ({"rules": {"senses": 3}}, "the senses are original, sighted, pixels"),
        ({"rules": {"turn_speed": 0}}, "rules.turn_speed: Input should be greater than 0"),
        ({"rules": {"spread": -1}}, "rules.spread: Input should be greater than"),
        ({"map": {"config": {"size": 41}}}, "map.config.size"),
        (
            {"map": {"config": {"storeys": [3, 1]}}},
            "map.config: storeys is (3, 1): the first number must not",
        ),
        ({"clock": "stopped"}, "clock: Input should be 'bank', 'paused', 'running' or 'tokens'"),
        ({"speed": 3}, "speed: Extra inputs are not permitted"),
        ({"start": [0, 0, float("nan")]}, "start.2"),
    ],
)
def test_an_invalid_spec_is_refused(fields: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError) as caught:
        MatchSpec.model_validate({"track": "battle", **fields})
    assert said in one_line(caught.value)
    assert "\n" not in one_line(caught.value)


def test_a_spec_survives_json() -> None:
    rules: dict[str, Any] = {"rules": Rules(shot_damage=7), "supplies": SupplyConfig(spacing=5)}
    spec = MatchSpec(track="battle", seats=("submission", "fighter"), seed=2**64 - 1, **rules)
    assert MatchSpec.model_validate_json(spec.model_dump_json()) == spec


def test_a_spec_names_its_clock_only_if_it_is_not_the_bank() -> None:
    assert "clock" not in MatchSpec(track="battle", clock="bank").model_dump()
    paused = MatchSpec(track="battle", clock="paused")
    assert MatchSpec.model_validate_json(paused.model_dump_json()) == paused
    assert paused != MatchSpec(track="battle")


def test_whole_numbers_for_real_rules_become_real() -> None:
    spec = MatchSpec.model_validate({"track": "battle", "rules": {"respawn_time": 3}})
    assert isinstance(spec.rules.respawn_time, float)


def test_the_defaults_are_the_originals() -> None:
    rules = Rules()
    assert (rules.start_health, rules.clip_size, rules.spare_ammo, rules.shot_damage) == (100, 15, 60, 20)
    assert (rules.respawn_time, rules.invincible_time, rules.supply_loss) == (10, 10, 0.5)
    assert (rules.water_speed_factor, rules.target_distance, rules.supply_sight) == (0.5, 1, 20)
    assert MatchSpec(track="navigation").frames_per_action == 5
    assert MapConfig().size == 100


def test_rules_added_later_are_in_specs_only_where_they_differ() -> None:
    first = set(Rules._fields[: Rules._fields.index("senses")])
    rules = Rules(senses=int(Senses.SIGHTED), spread=1.0)
    assert set(MatchSpec(track="battle").model_dump()["rules"]) == first
    assert set(MatchSpec(track="battle", rules=rules).model_dump()["rules"]) == first | {"senses", "spread"}


def test_rules_may_be_named() -> None:
    spec = MatchSpec.model_validate({"track": "battle", "rules": "fair"})
    assert spec.rules == NAMED["fair"]
    assert MatchSpec.model_validate_json(spec.model_dump_json()) == spec
    assert MatchSpec.model_validate({"track": "battle", "rules": "original"}) == MatchSpec(track="battle")


def test_fair_rules_stay_as_they_are() -> None:
    limits = {"turn_speed": 360.0, "spread": 0.5, "recoil": 0.5, "walking_sway": 9.0, "turning_sway": 2.0}
    assert NAMED["fair"] == Rules(senses=Senses.SIGHTED, **limits)
