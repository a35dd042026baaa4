"""Matches that are played to be measured, and the intervals of what they show."""

import pytest

from wildscav_engine.maps.pools import random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_training.opponents import named_agent
from wildscav_training.trials import Trial, estimate, matches_on, mean, play, rate, student

OPEN = MapSpec(config=MapConfig(size=40, houses=0, relief=0.0, water=0.0, vegetation=0.0), seed=1)


def test_every_agent_plays_the_same_matches_on_the_test_maps_of_a_level() -> None:
    drawn = list(matches_on("navigation", "easy", 3))

    pool = random_maps("easy", "test", size=3)
    assert [spec.map for spec in drawn] == [pool[number].spec for number in range(3)]
    assert [spec.seed for spec in drawn] == [0, 1, 2]
    assert {(spec.seats, spec.time_limit) for spec in drawn} == {((SUBMISSION,), 120.0)}


def test_levels_of_gathering_and_battle_differ_in_the_company_alone() -> None:
    easy, expert = (next(iter(matches_on("battle", level, 1))) for level in ("easy", "expert"))

    assert easy.seats == (SUBMISSION, *("walker-easy",) * 3)
    assert expert == easy.model_copy(update={"seats": (SUBMISSION, *("fighter-hard",) * 19)})
    assert next(iter(matches_on("gathering", "easy", 1))).map == easy.map


@pytest.mark.parametrize("name", ["straight", "oracle", "homing"])
def test_an_agent_is_measured_in_open_country(name: str) -> None:
    trial = play(named_agent(name), MatchSpec(track="navigation", map=OPEN, seed=2, time_limit=30.0))

    assert trial.metrics["success"] == 1.0
    assert trial.metrics["spl"] > 0.9
    assert trial.act_time > 0.0


def test_a_match_that_is_lost_counts_as_nothing() -> None:
    trial = play(named_agent("random"), MatchSpec(track="navigation", map=OPEN, seed=2, time_limit=0.5))

    assert (trial.metrics["success"], trial.metrics["spl"]) == (0.0, 0.0)


def test_intervals() -> None:
    trials = [Trial({"success": float(number < 9), "spl": 0.1 * number}, 0.0) for number in range(10)]

    assert estimate("success", trials) == pytest.approx((0.9, 0.5958, 0.9821), abs=1e-4)
    assert estimate("spl", trials) == pytest.approx((0.45, 0.2334, 0.6666), abs=1e-4)
    assert rate([1, 1, 0, 1]) == "75.0 % (30.1–95.4)"
    assert mean([0.5, 1.0], "+") == "+0.750 ± 3.177"
    assert mean([0.5]) == "0.500 ± 0.000"


@pytest.mark.parametrize(
    ("freedom", "errors"),  # as tables of Student's distribution have them
    [(1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (9, 2.262), (30, 2.042), (99, 1.984), (10_000, 1.960)],
)
def test_few_values_make_a_wide_interval(freedom: int, errors: float) -> None:
    assert student(freedom) == pytest.approx(errors, abs=5e-4)
