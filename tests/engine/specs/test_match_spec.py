"""Invalid specs are refused, in one line that says what is allowed."""

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
            "track is 'racing'; the tracks are navigation, gathering, capture, battle, royale",
        ),
        (
            {"track": "battle", "seats": ["wizard"]},
            "seat 0 is filled by 'wizard'; allowed are submission",
        ),
        ({"track": "battle", "seats": []}, "seats"),
        ({"track": "battle", "target": [0, 0, 0]}, "target is given, but battle has no target"),
        ({"track": "navigation", "supplies": {}}, "supplies is given, but navigation has no supplies"),
        ({"track": "battle", "time_limit": 0}, "time_limit: Input should be greater than 0, not 0"),
        ({"track": "battle", "seed": -1}, "seed"),
        ({"track": "battle", "rules": {"gravity": 1}}, "no rule is called gravity"),
        ({"track": "battle", "rules": {"supply_loss": 2}}, "supply_loss"),
        ({"track": "battle", "rules": "unfair"}, "no rules are called 'unfair'; allowed are original, fair"),
        ({"track": "battle", "rules": {"senses": "sixth"}}, "'sixth' are no senses; the senses are original"),
        ({"track": "battle", "rules": {"senses": 3}}, "the senses are original, sighted, pixels"),
        ({"track": "battle", "rules": {"turn_speed": 0}}, "rules.turn_speed: Input should be greater than 0"),
        ({"track": "battle", "rules": {"spread": -1}}, "rules.spread: Input should be greater than"),
        ({"track": "battle", "map": {"config": {"size": 41}}}, "map.config.size"),
        ({"track": "battle", "map": {"config": {"storeys": [3, 1]}}}, "storeys is (3, 1)"),
        (
            {"track": "battle", "clock": "stopped"},
            "clock: Input should be 'bank', 'paused', 'running' or 'tokens'",
        ),
        ({"track": "battle", "speed": 3}, "speed: Extra inputs are not permitted"),
        ({"track": "battle", "start": [0, 0, float("nan")]}, "start.2"),
    ],
)
def test_an_invalid_spec_is_refused(fields: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError) as caught:
        MatchSpec.model_validate(fields)
    assert said in one_line(caught.value)
    assert "\n" not in one_line(caught.value)


def test_a_spec_survives_json() -> None:
    spec = MatchSpec(
        track="battle",
        seats=("submission", "fighter"),
        seed=2**64 - 1,
        rules=Rules(shot_damage=7),
        supplies=SupplyConfig(spacing=5),
    )
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
    changed = {
        name: value for name, value in NAMED["fair"]._asdict().items() if value != Rules._field_defaults[name]
    }
    limits = {"turn_speed": 360.0, "spread": 0.5, "recoil": 0.5, "walking_sway": 9.0, "turning_sway": 2.0}
    assert changed == {"senses": Senses.SIGHTED, **limits}
