"""Fights: when to reload, which ones to leave, and where cover is."""

from typing import Any

import numpy as np
import pytest
from tests.platform.wildscav.skills.observations import enemy, match_info, seen

from wildscav import SupplyWave
from wildscav.geometry import flat_distance, moved
from wildscav.skills.fighting import (
    Dodging,
    cover_from,
    has_much_to_lose,
    is_hidden,
    quiet_place,
    steady,
    wants_reload,
    weave,
    would_lose,
)
from wildscav.skills.surroundings import Rings, Surroundings
from wildscav.skills.walking import Walk

ENEMY = (0.0, 0.0, 20.0)


@pytest.mark.parametrize(
    ("changes", "in_sight", "reloads"),
    [
        ({"clip": 0}, True, True),
        ({"clip": 1}, True, False),  # the last rounds are for the enemy in sight
        ({"clip": 8}, False, True),  # before it is empty, when nobody is in sight
        ({"clip": 9}, False, False),
        ({"clip": 0, "spare_ammo": 0}, False, False),
        ({"clip": 0, "reloading": True}, False, False),
    ],
)
def test_reloads(changes: dict[str, Any], in_sight: bool, reloads: bool) -> None:
    assert wants_reload(seen(**changes), 15, in_sight) is reloads


@pytest.mark.parametrize(
    ("changes", "health", "near", "leaves"),
    [
        ({}, 100, 1, False),
        ({"clip": 0}, 20, 1, True),  # unarmed
        ({"reloading": True}, 20, 1, True),
        ({"health": 40}, 60, 1, True),  # weak, and the weaker one
        ({"health": 40}, 20, 1, False),
        ({"health": 40}, 0, 1, True),  # nobody tells the enemy's health, so it may be unhurt
        ({}, 100, 3, True),  # outnumbered
    ],
)
def test_fights_that_are_left(changes: dict[str, Any], health: int, near: int, leaves: bool) -> None:
    enemies = [enemy(ENEMY, health=health)] * near

    assert would_lose(seen(**changes), enemies, 100) is leaves


@pytest.mark.parametrize(
    ("changes", "careful"),
    [
        ({"health": 40, "supplies": 100, "time": 20.0}, True),  # loses 50, could gather 40
        ({"health": 40, "supplies": 100, "time": 5.0}, False),
        ({"health": 60, "supplies": 100, "time": 20.0}, False),
    ],
)
def test_the_weak_are_careful_with_what_they_cannot_win_back(changes: dict[str, Any], careful: bool) -> None:
    assert has_much_to_lose(seen(**changes), match_info()) is careful


def walled() -> Surroundings:
    """A wall, 4 m wide, 3 m east of the agent, across the way to an enemy in the north."""
    surroundings = Surroundings(100.0, Rings(60.0, -55.0, 45.0))
    for x in np.arange(2.0, 6.0, 0.15):
        surroundings.block((float(x), 0.0, 1.5))
    return surroundings


@pytest.mark.parametrize(
    ("rules", "way", "speed"),
    [
        ({}, 20.0, 10.0),  # shots go where they are aimed
        ({"spread": 0.5, "walking_sway": 9.0}, 20.0, 1.75),  # 1.29° to each side: 2.58 times the spread
        ({"spread": 0.5, "walking_sway": 9.0}, 5.0, 10.0),
        ({"spread": 0.5, "walking_sway": 9.0}, 200.0, 1.0),
    ],
)
def test_where_walking_spreads_shots_it_walks_as_fast_as_they_still_hit(
    rules: dict[str, Any], way: float, speed: float
) -> None:
    walk = steady(match_info(**rules), seen(), enemy((0.0, 0.0, way)), Walk(90.0, 10.0))

    assert walk.direction == 90.0
    assert walk.speed == pytest.approx(speed, abs=0.01)


def test_cover_is_a_place_that_a_wall_hides() -> None:
    place = cover_from(walled(), (0.0, 0.0, 0.0), ENEMY)

    assert place is not None
    assert is_hidden(walled(), place, ENEMY)
    assert not is_hidden(walled(), (0.0, 0.0, 0.0), ENEMY)


def test_there_is_no_cover_on_open_ground() -> None:
    assert cover_from(Surroundings(100.0, Rings(60.0, -55.0, 45.0)), (0.0, 0.0, 0.0), ENEMY) is None


def test_dodging_is_across_the_line_of_fire_and_changes_sides() -> None:
    dodging, directions = Dodging(match_info()), set()
    for step in range(40):
        observation = seen(time=step / 10, position=(float(step), 0.0, 0.0))
        dodging.look(observation)
        directions.add(round(dodging.direction(seen(), ENEMY)))

    assert directions == {90, 270}


@pytest.mark.parametrize(
    ("direction", "way"),  # metres in two steps of 0.1 s: half of 2 m, or 1 m across and 0.4 m back
    [(0.0, 1.0), (180.0, 1.0), (90.0, 0.6), (270.0, 0.6)],
)
def test_weaving_changes_sides_in_every_step_and_gets_on(direction: float, way: float) -> None:
    place, sides = (0.0, 0.0, 0.0), []
    for step in range(2):
        walk = weave(seen(step=step), ENEMY, direction)
        after = moved(place, walk.direction, walk.speed * 0.1)
        sides.append(after[0] - place[0])
        place = after

    assert sides[0] * sides[1] < 0.0
    assert min(map(abs, sides)) > 0.39  # m, of the body's 0.45
    goal = moved((0.0, 0.0, 0.0), direction, 10.0)
    assert 10.0 - flat_distance(place, goal) == pytest.approx(way, abs=1e-6)


def test_a_hit_is_remembered_for_a_moment() -> None:
    dodging = Dodging(match_info())

    dodging.look(seen(time=5.0, hit_by_seat=1))

    assert dodging.is_under_fire(seen(time=5.5))
    assert not dodging.is_under_fire(seen(time=7.0))


def test_a_quiet_place_is_far_from_enemies_and_supplies() -> None:
    match = match_info(supply_waves=(SupplyWave(time=0.0, center=(40.0, 40.0), radius=5.0),))

    place = quiet_place(match, seen(), [(-40.0, 0.0, -40.0)])

    assert flat_distance(place, (40.0, 0.0, 40.0)) > 60.0
    assert flat_distance(place, (-40.0, 0.0, -40.0)) > 60.0
