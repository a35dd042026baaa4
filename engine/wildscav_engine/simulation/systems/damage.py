"""Damage, death and respawn."""

from wildscav_engine.arithmetic.random_numbers import Stream, Word, integer_in
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.linked_grid import link, square_of, squares_around
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import NOBODY, Agents, Game
from wildscav_engine.simulation.systems.agent_grid import AgentGrid, agent_grid_of
from wildscav_engine.simulation.systems.elimination import eliminate
from wildscav_engine.simulation.systems.supplies import drop_supplies
from wildscav_engine.simulation.systems.weapons import load_weapons
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, frames

RESPAWN_TRIES = 16  # random places that are tried before one near another agent is accepted
DIED = -1  # in place of the damage of an agent whose bounty has not been paid
RESPAWN_DISTANCE = 4.0 * BODY_RADIUS  # m to other agents


@inlined_kernel
def apply_damage(game: Game) -> None:
    """Subtract damage from health. Agents without health left die and drop a share of their supplies.

    Dead agents wait to respawn, or are eliminated in tracks without respawns. Agents that die in the same
    frame do so in its order, because there may not be a free slot for the supplies of each.
    """
    agents = game.agents
    for turn in range(agents.turns.shape[0]):
        seat = agents.turns[turn]
        if agents.damage[seat] != 0:
            _damage_agent(game, seat)
    if game.rules.bounty > 0:
        _pay_bounties(agents, game.rules.bounty)


@kernel
def _pay_bounties(agents: Agents, bounty: int) -> None:
    """Pay for the deaths of a frame after the last one, so that it does not matter who died first."""
    for seat in range(agents.damage.shape[0]):
        if agents.damage[seat] == DIED:
            agents.damage[seat] = 0
            if agents.hit_by_seat[seat] != NOBODY:
                agents.supplies[agents.hit_by_seat[seat]] += bounty


@kernel
def _damage_agent(game: Game, seat: int) -> None:
    agents, rules = game.agents, game.rules
    damage, agents.damage[seat] = agents.damage[seat], 0
    if agents.health[seat] <= 0:
        return
    agents.health[seat] = max(0, agents.health[seat] - damage)
    if agents.health[seat] > 0:
        return
    agents.deaths[seat] += 1
    agents.damage[seat] = DIED if rules.bounty > 0 else 0
    if agents.hit_by_seat[seat] != NOBODY:
        agents.kills[agents.hit_by_seat[seat]] += 1
    for axis in range(3):
        agents.velocity[seat, axis] = 0.0
    agents.reload_left[seat] = 0
    if game.matches.respawns[game.match]:
        agents.respawn_left[seat] = frames(rules.respawn_time)
    else:
        eliminate(agents, game.matches, game.match, seat)
    drop_supplies(game, seat)


@inlined_kernel
def respawn_agents(game: Game) -> None:
    """Count down the timers of respawn and invincibility, and respawn agents whose time is up.

    They do so in the order of the frame, because the place of one may not be free after another's return.
    """
    agents = game.agents
    for turn in range(agents.turns.shape[0]):
        seat = agents.turns[turn]
        agents.invincible_left[seat] = max(0, agents.invincible_left[seat] - 1)
        if agents.respawn_left[seat] > 0:
            agents.respawn_left[seat] -= 1
            if agents.respawn_left[seat] == 0:
                _respawn(game, seat)


@kernel
def _respawn(game: Game, seat: int) -> None:
    world, agents, matches, match = game.world, game.agents, game.matches, game.match
    grid, start = agent_grid_of(game), agents.start[seat]
    at_start = matches.respawns_at_start[match] and _is_away_from_agents(agents, grid, start[0], start[2])
    place = free_spawn(world, agents, grid, seat, matches.seed[match], matches.frame[match])
    equip(agents, seat)
    for axis in range(3):
        agents.position[seat, axis] = agents.start[seat, axis] if at_start else world.spawns[place, axis]
    agents.invincible_left[seat] = int(game.rules.invincible_time * FRAMES_PER_SECOND + 0.5)
    if agents.health.shape[0] > 1:  # a single agent is not indexed
        square = square_of(grid.squares, agents.position[seat, 0], agents.position[seat, 2])
        link(grid.heads, grid.links, square, seat)


@kernel
def equip(agents: Agents, seat: int) -> None:
    """Give an agent its equipment and reset its motion, except for its position."""
    agents.health[seat] = agents.full_health[seat]
    load_weapons(agents, seat)
    for axis in range(3):
        agents.velocity[seat, axis] = 0.0
    agents.pitch[seat] = 0.0
    agents.on_ground[seat] = True


@kernel
def free_spawn(world: World, agents: Agents, grid: AgentGrid, seat: int, seed: Word, frame: int) -> int:
    """Return the index of a random spawn, away from living agents if one is found in some tries."""
    place = 0
    for attempt in range(RESPAWN_TRIES):
        place = integer_in(0, world.spawns.shape[0] - 1, seed, Stream.RESPAWN, frame, seat, attempt)
        if _is_away_from_agents(agents, grid, world.spawns[place, 0], world.spawns[place, 2]):
            break
    return place


@kernel
def _is_away_from_agents(agents: Agents, grid: AgentGrid, x: float, z: float) -> bool:
    """Return whether no living agent is near a place."""
    squares = grid.squares
    around = squares_around(squares, x, z, RESPAWN_DISTANCE)
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            seat = grid.heads[row * squares.side + column] - 1
            while seat >= 0:
                dx, dz = agents.position[seat, 0] - x, agents.position[seat, 2] - z
                if dx * dx + dz * dz <= RESPAWN_DISTANCE * RESPAWN_DISTANCE:
                    return False
                seat = grid.links[seat] - 1
    return True
