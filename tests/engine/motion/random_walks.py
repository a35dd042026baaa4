"""Random walkers simulated in a kernel, and the worst violations of the rules of motion."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import uniform
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.motion.body_motion import move
from wildscav_engine.motion.collision import Bodies, find_nearby_solids
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, EDGE_MARGIN, GRAVITY, JUMP_SPEED
from wildscav_engine.specs.rules import FRAME

HELD = 5  # frames per action
TRIED = 1000  # frames between tests of whether a body is stuck
AWAY = 0.3  # m
TRIAL = 60  # frames


class Worst(NamedTuple):
    """The worst of all frames."""

    speed: float  # m/s sideways
    fall: float  # m/s downwards
    below_ground: float  # m
    inside: float  # m deep in a solid; negative: how far off all of them
    overlap: float  # m that bodies overlap sideways while they do in height
    walked_up: float  # m in a frame on the feet
    energy: float  # J/kg that a frame of flight added
    differences: float  # frames that the general path plays otherwise
    wedged: float  # bodies that could not get away
    not_finite: float  # frames
    beyond: float  # m beyond what is kept from the edge of the map


WORST = np.array([0.0, 0.0, -np.inf, -np.inf, -np.inf, 0.0, -np.inf, 0.0, 0.0, 0.0, -np.inf])


@kernel
def play(
    world: World,
    closed: World,
    position: NDArray[np.float64],
    others: NDArray[np.int32],
    nobody: NDArray[np.int32],
    rise: NDArray[np.float64],
    on_ground: NDArray[np.bool_],
    frames: int,
    seed: int,
    worst: NDArray[np.float64],
    stuck: NDArray[np.float64],
) -> None:
    """Play all bodies at random, and raise ``worst``.

    Args:
        world: The static world.
        closed: The same world, but with a ceiling that forces the general path everywhere.
        position: (A + 1, 3) m; the last body is a ghost that is only used for trials of being stuck.
        others: (A,) all bodies, which collide with each other.
        nobody: (0,) trials ignore other bodies, which move away by themselves.
        rise: (A,) m/s.
        on_ground: (A,).
        frames: To play.
        seed: Of the actions.
        worst: (11,) as in ``Worst``.
        stuck: (3,) m, where a body could not get away.
    """
    for frame in range(frames):
        for seat in range(rise.shape[0]):
            choice = frame // HELD
            direction = 360.0 * uniform(seed, 1, choice // 4, seat, 0)
            speed = min(10.0, 14.0 * uniform(seed, 1, choice, seat, 1))
            jump = uniform(seed, 1, choice, seat, 2) < 0.3
            bodies = Bodies(position, others, seat)
            before, was_rise, walks = position[seat, 1], rise[seat], on_ground[seat] and not jump
            moved = move(world, bodies, rise[seat], on_ground[seat], direction, speed, jump, 0.5)
            other = move(closed, bodies, rise[seat], on_ground[seat], direction, speed, jump, 0.5)
            same = moved.x == other.x and moved.y == other.y and moved.z == other.z
            same = same and moved.rise == other.rise and moved.on_ground == other.on_ground
            worst[7] += 0.0 if same else 1.0
            dx, dz = moved.x - position[seat, 0], moved.z - position[seat, 2]
            worst[0] = max(worst[0], np.sqrt(dx * dx + dz * dz) / FRAME)
            worst[1] = max(worst[1], -moved.rise)
            if walks:
                worst[5] = max(worst[5], moved.y - before)
            elif not moved.on_ground:
                begun = JUMP_SPEED if on_ground[seat] else was_rise
                gained = GRAVITY * (moved.y - before) + 0.5 * (moved.rise * moved.rise - begun * begun)
                worst[6] = max(worst[6], gained)
            position[seat, 0], position[seat, 1], position[seat, 2] = moved.x, moved.y, moved.z
            rise[seat], on_ground[seat] = moved.rise, moved.on_ground
            _judge_place(world, position, seat, worst)
            is_tried = (frame + 37 * seat) % TRIED == TRIED - 1
            if is_tried and not _gets_away(world, position, nobody, seat, rise[seat], on_ground[seat]):
                worst[8] += 1.0
                stuck[0], stuck[1], stuck[2] = moved.x, moved.y, moved.z


@kernel
def _judge_place(world: World, position: NDArray[np.float64], seat: int, worst: NDArray[np.float64]) -> None:
    x, y, z = position[seat]
    if not (np.isfinite(x) and np.isfinite(y) and np.isfinite(z)):
        worst[9] += 1.0
        return
    half = -world.corner[0] - EDGE_MARGIN
    worst[10] = max(worst[10], abs(x) - half, abs(z) - half)
    worst[2] = max(worst[2], ground_at(world, x, z).height - y)
    worst[3] = max(worst[3], depth_inside(world, x, y, z))
    for other in range(position.shape[0] - 1):
        if other != seat and abs(position[other, 1] - y) < BODY_HEIGHT:
            dx, dz = position[other, 0] - x, position[other, 2] - z
            worst[4] = max(worst[4], 2.0 * BODY_RADIUS - np.sqrt(dx * dx + dz * dz))


@kernel
def depth_inside(world: World, x: float, y: float, z: float) -> float:
    """Return the greatest depth in m of a body in a solid; negative: its distance from all solids."""
    deepest = -np.inf
    columns = world.water.shape[1]
    near = find_nearby_solids(world, x, z, BODY_RADIUS + 0.1, y - 0.1, y + BODY_HEIGHT + 0.1)
    parts = (near.south_west, near.south_east, near.north_west, near.north_east)
    for part in range(4):
        cell = (near.row + part // 2) * columns + near.column + part % 2
        bits = parts[part]
        item = 0
        while bits != 0:
            if bits & 1 != 0:
                solid = world.cell_solids[world.cell_start[cell] + item]
                deepest = max(deepest, -_outside(world, solid, x, y, z))
            bits >>= 1
            item += 1
    return deepest


@kernel
def _outside(world: World, solid: int, x: float, y: float, z: float) -> float:
    low, high = world.solid_low[solid], world.solid_high[solid]
    outside = max(low[1] - BODY_HEIGHT - y, y - high[1])
    outside = max(outside, low[0] - BODY_RADIUS - x, x - high[0] - BODY_RADIUS)
    outside = max(outside, low[2] - BODY_RADIUS - z, z - high[2] - BODY_RADIUS)
    for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
        n = world.faces[face]
        outside = max(outside, n[0] * x + n[1] * y + n[2] * z - n[3] - world.face_reach[face])
    return outside


@kernel
def _gets_away(
    world: World,
    position: NDArray[np.float64],
    nobody: NDArray[np.int32],
    seat: int,
    rise: float,
    on_ground: bool,
) -> bool:
    """Return whether a body gets AWAY from where it is in any of 16 directions, walking or jumping."""
    ghost = position.shape[0] - 1
    for trial in range(32):
        for axis in range(3):
            position[ghost, axis] = position[seat, axis]
        up, stands = rise, on_ground
        for _ in range(TRIAL):
            bodies = Bodies(position, nobody, ghost)
            moved = move(world, bodies, up, stands, 22.5 * (trial % 16), 3.0, trial >= 16, 0.5)
            position[ghost, 0], position[ghost, 1], position[ghost, 2] = moved.x, moved.y, moved.z
            up, stands = moved.rise, moved.on_ground
            dx, dz = moved.x - position[seat, 0], moved.z - position[seat, 2]
            if dx * dx + dz * dz > AWAY * AWAY:
                return True
    return False
