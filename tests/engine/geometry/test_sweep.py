"""How far a body goes, 0.45 m in radius and 1.78 m tall, before it is 1 mm away from something."""

import math

import numpy as np
import pytest
from tests.builders import box, flat_world

from wildscav_engine.geometry.clearance import is_free
from wildscav_engine.geometry.sweep import (
    FREE,
    SKIN,
    Contact,
    box_of_sweep,
    is_apart,
    is_body_near,
    sweep_bodies,
    sweep_world,
)
from wildscav_engine.geometry.world import Solid, World

WORLD = flat_world(40, [box((2, 1, -5), (3, 3, 5))])  # a wall 1 m above ground, west side at x = 2
HERE = (0.0, 0.0, 0.0)
EVERYBODY = np.arange(4, dtype=np.int32)


@pytest.mark.parametrize(
    ("start", "way", "free", "normal"),
    [
        (HERE, (10, 0, 0), 2 - 0.45 - SKIN, (-1, 0, 0)),  # against its west side
        ((6, 0, 0), (-10, 0, 0), 3 - 0.45 - SKIN, (1, 0, 0)),  # against its east side
        ((2.5, 0, 9), (0, 0, -10), 4 - 0.45 - SKIN, (0, 0, 1)),
        ((2.5, 0, -9), (0, 0, 10), 4 - 0.45 - SKIN, (0, 0, -1)),
        ((2.5, 5, 0), (0, -10, 0), 2 - SKIN, (0, 1, 0)),  # down onto it
        ((2.5, -4, 0), (0, 10, 0), 5 - 1.78 - SKIN, (0, -1, 0)),  # the head against its underside
        (HERE, (-10, 0, 0), 10, (0, 0, 0)),  # away from it
        ((0, 3.001, 0), (10, 0, 0), 10, (0, 0, 0)),  # along its top
        ((0, -0.8, 0), (10, 0, 0), 10, (0, 0, 0)),  # below it: 1.78 - 0.8 = 0.98
        ((0, -0.77, 0), (10, 0, 0), 2 - 0.45 - SKIN, (-1, 0, 0)),
        ((0, 0, 5.46), (10, 0, 0), 10, (0, 0, 0)),  # past its end
        ((2.5, 1.5, 0), (10, 0, 0), 10, (0, 0, 0)),  # what is inside may leave
        ((1.5495, 0, 0), (0, 0, 3), 3, (0, 0, 0)),  # along it while touching it
        ((1.5495, 0, 0), (1, 0, 0), 0, (-1, 0, 0)),  # into it while touching it
    ],
)
def test_how_far_a_body_goes(
    start: tuple[float, ...], way: tuple[float, ...], free: float, normal: tuple[float, ...]
) -> None:
    contact = sweep_world(WORLD, *map(float, start), *map(float, way))

    length = math.hypot(*way)
    assert contact.fraction * length == pytest.approx(free, abs=1e-9)
    assert contact[1:] == pytest.approx(normal)


def test_no_way_is_too_fast_for_a_thin_wall() -> None:
    thin = flat_world(40, [box((2, 0, -5), (2.01, 3, 5))])

    assert sweep_world(thin, -15.0, 0.0, 0.0, 30.0, 0.0, 0.0).fraction * 30 == pytest.approx(17 - 0.45 - SKIN)


def random_world(dice: np.random.Generator) -> World:
    solids: list[Solid] = []
    for x, z, bottom in dice.uniform((-8, -8, -1), (8, 8, 2), (25, 3)):
        width, height, depth = dice.uniform(0.2, 3, 3)
        solids.append(box((x, bottom, z), (x + width, bottom + height, z + depth)))
    return flat_world(40, solids)


def is_open(world: World, place: np.ndarray) -> bool:
    """Whether a body at a place touches no solid."""
    return is_free(world, place[0], place[1], place[1] + 1.78, place[2], 0.0)


def test_nothing_is_touched_before_the_contact_and_something_right_behind_it() -> None:
    dice = np.random.default_rng(5)
    stopped = 0
    world = random_world(dice)
    for start in dice.uniform((-8, 0, -8), (8, 3, 8), (400, 3)):
        way = dice.uniform(-6, 6, 3)
        if not is_open(world, start):
            continue
        contact = sweep_world(world, *start, *way)
        for share in np.linspace(0.0, contact.fraction, 12):
            assert is_open(world, start + way * share)
        if contact != FREE:
            stopped += 1
            touched = start + way * contact.fraction - np.array(contact[1:]) * 3 * SKIN
            assert not is_open(world, touched)
    assert stopped > 100


def test_a_box_that_the_swept_box_does_not_reach_is_apart() -> None:
    reach = 0.45 + 2 * SKIN
    swept = box_of_sweep(0.0, 0.0, 0.0, 1.0, -0.5, -2.0)
    assert swept == pytest.approx((-reach, -0.5 - 2 * SKIN, -2 - reach, 1 + reach, 1.78 + 2 * SKIN, reach))

    assert not is_apart(WORLD, 0, swept._replace(east=2.0))  # they touch
    assert is_apart(WORLD, 0, swept)
    beyond = {"bottom": 3.1, "top": 0.9, "east": 1.9, "west": 3.1, "north": -5.1, "south": 5.1}
    for side, value in beyond.items():
        around = swept._replace(west=0.0, bottom=0.0, south=-9.0, east=9.0, top=9.0, north=9.0)
        assert not is_apart(WORLD, 0, around)
        assert is_apart(WORLD, 0, around._replace(**{side: value}))


BODIES = np.array([(0, 0, 0), (3, 0, 0), (0, 1, 4), (0, 5, 0)], float)


@pytest.mark.parametrize(
    ("start", "way", "contact"),
    [
        (HERE, (4, 0, 0), Contact((3 - 0.9 - SKIN) / 4, -1, 0, 0)),  # two radii apart
        (HERE, (0, 0, 8), Contact((4 - 0.9 - SKIN) / 8, 0, 0, -1)),  # 1 m higher, but 1.78 m tall
        (HERE, (0, 8, 0), Contact((5 - 1.78 - SKIN) / 8, 0, -1, 0)),  # its head against the other's soles
        (HERE, (-9, 0, 0), FREE),
        (HERE, (1, 0, 0), FREE),  # it does not get there
        ((0, 0, 0.91), (4, 0, 0), FREE),  # past it: the axes are 0.91 m apart
        ((0, 1.79, 0), (4, 0, 0), FREE),  # over its head
        ((2.5, 0, 0), (4, 0, 0), FREE),  # those that overlap do not hold each other
        ((2.0995, 0, 0), (1, 0, 0), Contact(0, -1, 0, 0)),  # closer than the skin: no farther
        ((2.0995, 0, 0), (-1, 0, 0), FREE),  # but back
    ],
)
def test_how_far_a_body_goes_among_bodies(
    start: tuple[float, ...], way: tuple[float, ...], contact: Contact
) -> None:
    found = sweep_bodies(BODIES, EVERYBODY, 0, *map(float, start), *map(float, way))

    assert found == pytest.approx(contact, abs=1e-9)


def test_bodies_meet_at_a_slant() -> None:
    # The way passes 0.54 m beside the other's axis, so they touch sqrt(0.9² - 0.54²) = 0.72 m before it.
    found = sweep_bodies(BODIES[:2], EVERYBODY[:2], 0, 0.0, 0.0, 0.54, 5.0, 0.0, 0.0)

    assert found.fraction * 5 == pytest.approx(3 - 0.72, abs=2 * SKIN)
    assert found[1:] == pytest.approx((-0.8, 0, 0.6), abs=2e-3)


@pytest.mark.parametrize(
    ("place", "reach", "near"),
    [
        ((1.0, 0.0, 0.0), 1.0, False),  # 2 m from the body at (3, 0, 0), 0.9 m of which the two take
        ((1.0, 0.0, 0.0), 1.2, True),
        ((-1.0, 0.0, 0.0), 3.0, False),  # 4 > 3 + 0.9
        ((-1.0, 0.0, 0.0), 3.2, True),
        ((3.0, 3.5, 0.0), 0.0, True),  # within two heights above
        ((3.0, 3.6, 0.0), 0.0, False),
    ],
)
def test_bodies_are_near_that_a_move_could_touch(
    place: tuple[float, float, float], reach: float, near: bool
) -> None:
    assert is_body_near(BODIES[:2], EVERYBODY[:2], 0, *place, reach) is near


def test_nobody_is_near_itself() -> None:
    assert not is_body_near(BODIES[:1], EVERYBODY[:1], 0, 0.0, 0.0, 0.0, 9.0)
    assert sweep_bodies(BODIES[:1], EVERYBODY[:1], 0, 0.2, 0.0, 0.0, 9.0, 0.0, 0.0) == FREE
