"""Damage, death, what a dead agent loses, and its return."""

from wildscav_engine.body import BODY_RADIUS
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.rng import Stream, Word, integer_in
from wildscav_engine.rules import Rules, frames
from wildscav_engine.state import NOBODY, Agents, Matches, Supplies
from wildscav_engine.systems.elimination import eliminate
from wildscav_engine.systems.supplies import drop_supplies

RESPAWN_TRIES = 16  # places looked at before one beside another agent is taken
RESPAWN_DISTANCE = 4.0 * BODY_RADIUS  # m kept from other agents


@kernel
def apply_damage(agents: Agents, supplies: Supplies, matches: Matches, match: int, rules: Rules) -> None:
    """Take health away; who has none left dies and drops a share of its supplies.

    It waits to come back, or is out for good where nobody comes back.

    Args:
        agents: The agents of the match.
        supplies: The boxes of the match.
        matches: All matches.
        match: Which one it is.
        rules: The rules.
    """
    for seat in range(agents.health.shape[0]):
        hurt, agents.damage[seat] = agents.damage[seat], 0
        if hurt == 0 or agents.health[seat] <= 0:
            continue
        agents.health[seat] = max(0, agents.health[seat] - hurt)
        if agents.health[seat] == 0:
            agents.deaths[seat] += 1
            if agents.hit_by_seat[seat] != NOBODY:
                agents.kills[agents.hit_by_seat[seat]] += 1
            agents.velocity[seat] = 0.0
            agents.reload_left[seat] = 0
            if matches.respawns[match]:
                agents.respawn_left[seat] = frames(rules.respawn_time)
            else:
                eliminate(agents, matches, match, seat)
            drop_supplies(agents, supplies, matches, match, seat, rules.supply_loss)


@kernel
def bring_back(world: World, agents: Agents, matches: Matches, match: int, rules: Rules) -> None:
    """Count down respawn and invincibility; bring back the agents whose time has come."""
    for seat in range(agents.health.shape[0]):
        agents.invincible_left[seat] = max(0, agents.invincible_left[seat] - 1)
        if agents.respawn_left[seat] > 0:
            agents.respawn_left[seat] -= 1
            if agents.respawn_left[seat] == 0:
                place = free_spawn(
                    world, agents, seat, matches.seed[match], Stream.RESPAWN, matches.frame[match]
                )
                equip(agents, seat, rules)
                for axis in range(3):
                    agents.position[seat, axis] = world.spawns[place, axis]
                agents.invincible_left[seat] = int(rules.invincible_time * 50.0 + 0.5)


@kernel
def equip(agents: Agents, seat: int, rules: Rules) -> None:
    """Give an agent all that it starts with, but no place."""
    agents.health[seat] = rules.start_health
    agents.clip[seat] = rules.clip_size
    agents.spare_ammo[seat] = rules.spare_ammo
    agents.reload_left[seat] = 0
    agents.fire_left[seat] = 0
    agents.velocity[seat] = 0.0
    agents.pitch[seat] = 0.0
    agents.on_ground[seat] = True


@kernel
def free_spawn(world: World, agents: Agents, seat: int, seed: Word, stream: int, frame: int) -> int:
    """Return the index of a random spawn that keeps away from the living, if one is found in some tries."""
    place = 0
    for attempt in range(RESPAWN_TRIES):
        place = integer_in(0, world.spawns.shape[0] - 1, seed, stream, frame, seat, attempt)
        free = True
        for other in range(agents.health.shape[0]):
            if other != seat and agents.health[other] > 0:
                dx = agents.position[other, 0] - world.spawns[place, 0]
                dz = agents.position[other, 2] - world.spawns[place, 2]
                free = free and dx * dx + dz * dz > RESPAWN_DISTANCE * RESPAWN_DISTANCE
        if free:
            break
    return place
