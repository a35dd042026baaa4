"""Damage, death, what a dead agent loses, and its return."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Stream, Word, integer_in
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.linked_grid import Squares, link, square_of, squares_around
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import NOBODY, Agents, Matches, Supplies
from wildscav_engine.simulation.systems.crowd import crowd_of
from wildscav_engine.simulation.systems.elimination import eliminate
from wildscav_engine.simulation.systems.supplies import drop_supplies
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, Rules, frames

RESPAWN_TRIES = 16  # places looked at before one beside another agent is taken
RESPAWN_DISTANCE = 4.0 * BODY_RADIUS  # m kept from other agents


@inlined_kernel
def apply_damage(
    world: World, agents: Agents, supplies: Supplies, matches: Matches, match: int, rules: Rules
) -> None:
    """Take health away; who has none left dies and drops a share of its supplies.

    It waits to come back, or is out for good where nobody comes back.

    Args:
        world: The static world.
        agents: The agents of the match.
        supplies: The boxes of the match.
        matches: All matches.
        match: Which one it is.
        rules: The rules.
    """
    for seat in range(agents.health.shape[0]):
        if agents.damage[seat] != 0:
            _hurt(world, agents, supplies, matches, match, seat, rules)


@kernel
def _hurt(
    world: World,
    agents: Agents,
    supplies: Supplies,
    matches: Matches,
    match: int,
    seat: int,
    rules: Rules,
) -> None:
    hurt, agents.damage[seat] = agents.damage[seat], 0
    if agents.health[seat] <= 0:
        return
    agents.health[seat] = max(0, agents.health[seat] - hurt)
    if agents.health[seat] > 0:
        return
    agents.deaths[seat] += 1
    if agents.hit_by_seat[seat] != NOBODY:
        agents.kills[agents.hit_by_seat[seat]] += 1
    for axis in range(3):
        agents.velocity[seat, axis] = 0.0
    agents.reload_left[seat] = 0
    if matches.respawns[match]:
        agents.respawn_left[seat] = frames(rules.respawn_time)
    else:
        eliminate(agents, matches, match, seat)
    drop_supplies(world, agents, supplies, matches, match, seat, rules.supply_loss)


@inlined_kernel
def bring_back(world: World, agents: Agents, matches: Matches, match: int, rules: Rules) -> None:
    """Count down respawn and invincibility; bring back the agents whose time has come."""
    for seat in range(agents.health.shape[0]):
        agents.invincible_left[seat] = max(0, agents.invincible_left[seat] - 1)
        if agents.respawn_left[seat] > 0:
            agents.respawn_left[seat] -= 1
            if agents.respawn_left[seat] == 0:
                _come_back(world, agents, matches, match, seat, rules)


@kernel
def _come_back(world: World, agents: Agents, matches: Matches, match: int, seat: int, rules: Rules) -> None:
    squares, heads, links = crowd_of(world, agents, matches, match)
    start = agents.start[seat]
    at_start = matches.respawns_at_start[match] and _is_free(agents, squares, heads, start[0], start[2])
    place = free_spawn(world, agents, squares, heads, seat, matches.seed[match], matches.frame[match])
    equip(agents, seat)
    for axis in range(3):
        agents.position[seat, axis] = agents.start[seat, axis] if at_start else world.spawns[place, axis]
    agents.invincible_left[seat] = int(rules.invincible_time * FRAMES_PER_SECOND + 0.5)
    if agents.health.shape[0] > 1:  # one that is alone is not indexed
        link(heads, links, square_of(squares, agents.position[seat, 0], agents.position[seat, 2]), seat)


@kernel
def equip(agents: Agents, seat: int) -> None:
    """Give an agent all that it starts with, but no place."""
    agents.health[seat] = agents.full_health[seat]
    agents.clip[seat] = agents.clip_size[seat]
    agents.spare_ammo[seat] = agents.full_spare_ammo[seat]
    agents.reload_left[seat] = 0
    agents.fire_left[seat] = 0
    for axis in range(3):
        agents.velocity[seat, axis] = 0.0
    agents.pitch[seat] = 0.0
    agents.on_ground[seat] = True


@kernel
def free_spawn(
    world: World,
    agents: Agents,
    squares: Squares,
    heads: NDArray[np.int32],
    seat: int,
    seed: Word,
    frame: int,
) -> int:
    """Return the index of a random spawn that keeps away from the living, if one is found in some tries."""
    place = 0
    for attempt in range(RESPAWN_TRIES):
        place = integer_in(0, world.spawns.shape[0] - 1, seed, Stream.RESPAWN, frame, seat, attempt)
        if _is_free(agents, squares, heads, world.spawns[place, 0], world.spawns[place, 2]):
            break
    return place


@kernel
def _is_free(agents: Agents, squares: Squares, heads: NDArray[np.int32], x: float, z: float) -> bool:
    """Return whether all of the living keep away from a place."""
    around = squares_around(squares, x, z, RESPAWN_DISTANCE)
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            seat = heads[row * squares.side + column] - 1
            while seat >= 0:
                dx, dz = agents.position[seat, 0] - x, agents.position[seat, 2] - z
                if dx * dx + dz * dz <= RESPAWN_DISTANCE * RESPAWN_DISTANCE:
                    return False
                seat = agents.next_in_square[seat] - 1
    return True
