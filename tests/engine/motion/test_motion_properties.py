"""Invariants of motion, over random frames on random maps."""

import numpy as np
import pytest
from tests.builders import box, map_from, random_map_config
from tests.engine.motion.random_walks import WORST, Worst, play

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.shapes import box as solid_box
from wildscav_engine.geometry.shapes import pose
from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.world import Kind, build_world
from wildscav_engine.maps import GameMap, MapError, generate_map
from wildscav_engine.motion.walking import LIFT
from wildscav_engine.specs.body import FALL_SPEED_LIMIT, GRAVITY
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.rules import FRAME

# A body stopped by steep faces keeps at most half of what gravity adds in a frame; J/kg.
HELD_UP = 0.5 * (0.5 * GRAVITY * FRAME) ** 2 + 1e-9


def play_on(game_map: GameMap, agents: int, frames: int, seed: int) -> Worst:
    """Simulate agents from random places of a map, half of them indoors, and return the worst violations."""
    world, dice = game_map.world, RandomStream(seed, Stream.TARGET)
    closed = world._replace(ceiling=np.full_like(world.ceiling, -np.inf))
    worst, stuck = WORST.copy(), np.zeros(3)
    for part in range(max(1, frames // 2000)):
        position = np.zeros((agents + 1, 3))
        for seat in range(agents):
            indoors = seat % 2 == 1 and len(game_map.indoor) > 0
            places = game_map.indoor if indoors else world.spawns
            chosen = places[(dice.integer(0, len(places) - 1) + 7 * seat) % len(places)]
            position[seat] = chosen + np.array([0.0, 2 * SKIN, 0.0])
        apart = np.linalg.norm(position[:agents, None] - position[None, :agents], axis=2)
        others = np.arange(agents, dtype=np.int32)  # the ghost is no obstacle
        # A body that would start where another stands starts high above instead, falling.
        for seat in range(agents):
            if (apart[seat, :seat] < 2.0).any():
                position[seat] = (*world.spawns[(7 * seat + part) % len(world.spawns)][::2], 0.0)
                position[seat] = position[seat, 0], 60.0 + 3.0 * seat, position[seat, 1]
        rise, on_ground = np.zeros(agents), np.zeros(agents, np.bool_)
        length, actions = min(frames, 2000), 1000 * seed + part
        nobody = np.zeros(0, np.int32)
        play(world, closed, position, others, nobody, rise, on_ground, length, actions, worst, stuck)
    assert worst[8] == 0, f"seed {seed}: no way out of {stuck}"
    return Worst(*worst)


def check(worst: Worst) -> None:
    assert worst.not_finite == worst.differences == worst.wedged == 0
    assert max(worst.beyond, worst.below_ground) <= 1e-9
    assert max(worst.inside, worst.overlap) < 0.0
    assert worst.speed <= 10.0 + 1e-9
    assert worst.fall <= FALL_SPEED_LIMIT
    assert worst.walked_up <= LIFT + 1e-9
    assert worst.energy <= HELD_UP


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, houses=3, storeys=(1, 3), vegetation=0.8), 4)


def test_nothing_bad_happens_to_a_few_in_a_village(country: GameMap) -> None:
    check(play_on(country, agents=6, frames=4_000, seed=1))


def test_nothing_bad_happens_in_a_crowd(country: GameMap) -> None:
    check(play_on(country, agents=30, frames=600, seed=2))


def crowded_edges(steepness: float) -> GameMap:
    """Return a map that rises diagonally, with rotated blocks, a roof and steep rocks along its edges."""
    side = np.arange(21) * 2.0 - 20.0
    heights = steepness * np.maximum(0.0, (side[:, None] + side[None, :]) * 0.5)
    solids = []
    for number, along in enumerate(range(-16, 17, 4)):
        for x, z in ((along, 18.6), (along, -18.6), (18.6, along), (-18.6, along)):
            ground = steepness * max(0.0, 0.5 * (x + z))
            turned = pose(x, z, 23.0 * number - 40.0 + x)
            high = ground + (0.5, 1.0, 3.0)[number % 3]
            solids.append(solid_box(Kind.WALL, turned, (-1.5, ground - 3.0, -0.2), (1.5, high, 0.2)))
    solids.append(box((-20, 2.2, -20), (-14, 2.5, -17), Kind.ROOF))
    world = build_world((-20.0, -20.0), heights, np.full((20, 20), -np.inf), solids, np.zeros((0, 3)))
    spots = [(x, z) for x in (-13.0, 0.0, 13.0) for z in (-13.0, 0.0, 13.0)]
    places = [(x, steepness * max(0.0, 0.5 * (x + z)), z) for x, z in spots]
    return map_from(world._replace(spawns=np.array(places)))


@pytest.mark.parametrize("steepness", [0.0, 1.2, 2.2])
def test_nobody_leaves_the_map_along_what_stands_at_its_edge(steepness: float) -> None:
    check(play_on(crowded_edges(steepness), agents=9, frames=4_000, seed=3))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_nothing_bad_happens_in_many_frames_on_random_maps(seed: int) -> None:
    config = random_map_config(seed, steepest=1.8)
    try:
        game_map = generate_map(config, seed)
    except MapError:  # steep and wet, and more houses than fit
        game_map = generate_map(config.model_copy(update={"houses": 0, "water": 0.0}), seed)
    check(play_on(game_map, agents=10, frames=10_000, seed=seed))
