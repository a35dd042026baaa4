"""The kernels that ``Batch`` calls: they access its arrays through address tables."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel, specialize
from wildscav_engine.compilation.tables.array_tables import Addresses, number_reader, reader, row_reader
from wildscav_engine.maps.bank import world_at
from wildscav_engine.simulation.state import Game, allocate_state, matches_at
from wildscav_engine.simulation.step import let_robots_decide, play_step, resolve_actions
from wildscav_engine.simulation.systems.agent_grid import index_agents
from wildscav_engine.simulation.systems.visibility import allocate_seen, find_seen
from wildscav_engine.specs.rules import Rules

_EXAMPLE = allocate_state(1, 1, 1, 1, 1, 1)
# Kernels that return the arrays of one match from their address tables.
agents_of = row_reader(_EXAMPLE.agents)
supplies_of = row_reader(_EXAMPLE.supplies)
seen_of = row_reader(allocate_seen(1, 1))
rules_from = number_reader(Rules())


class BatchArrays(NamedTuple):
    """Everything that kernels need of a batch: a table of tables, so that a call passes only one array."""

    bank: NDArray[np.int64]  # (M, F, 6) the table of each map's world
    agents: Addresses
    supplies: Addresses
    matches: Addresses
    seen: Addresses
    allowed: NDArray[np.bool_]  # (FIELDS,) the action set of the track
    rules: NDArray[np.float64]  # the numbers of ``Rules``


_TABLE = np.zeros((1, 1), np.int64)
batch_at = reader(
    BatchArrays(_TABLE[None], _TABLE, _TABLE, _TABLE, _TABLE, np.zeros(1, np.bool_), np.zeros(1))
)


@kernel
def play_batch(
    table: Addresses,
    rows: NDArray[np.int64],
    actions: NDArray[np.float32],
    frames_per_action: int,
    is_reset: bool,
) -> None:
    """Begin the matches in some rows, or play one step of those that are not over.

    The actions are replaced by those that were played. One kernel does both, because beginning and playing
    share most of the code to compile.
    """
    batch = batch_at(table)
    matches = matches_at(batch.matches)
    for index in range(rows.shape[0]):
        match = rows[index]
        if not matches.over[match]:
            seats = matches.seats[match]
            world = world_at(batch.bank[matches.map_index[match]])
            agents = agents_of(batch.agents, match, seats)
            supplies = supplies_of(batch.supplies, match, matches.slots[match])
            rules, played = rules_from(batch.rules), actions[match][:seats]
            game = Game(world, agents, supplies, matches, match, rules)
            if not is_reset:
                resolve_actions(agents, played, batch.allowed)
            play_step(game, played, frames_per_action, is_reset)


@kernel
def play_batch_with_robots(
    table: Addresses,
    rows: NDArray[np.int64],
    actions: NDArray[np.float32],
    frames_per_action: int,
    is_reset: bool,
) -> None:
    """Do the same as ``play_batch`` where robots play. Their code takes long to compile."""
    batch = batch_at(table)
    matches = matches_at(batch.matches)
    for index in range(rows.shape[0]):
        match = rows[index]
        if not matches.over[match]:
            seats = matches.seats[match]
            world = world_at(batch.bank[matches.map_index[match]])
            agents = agents_of(batch.agents, match, seats)
            supplies = supplies_of(batch.supplies, match, matches.slots[match])
            rules, played = rules_from(batch.rules), actions[match][:seats]
            game = Game(world, agents, supplies, matches, match, rules)
            if not is_reset:
                seen = seen_of(batch.seen, match, seats)
                let_robots_decide(game, seen, played, batch.allowed, frames_per_action)
            play_step(game, played, frames_per_action, is_reset)


@kernel
def find_seen_in_batch(table: Addresses, rows: NDArray[np.int64], seats: NDArray[np.int64]) -> None:
    """Update what some seats of the matches in some rows see."""
    batch = batch_at(table)
    matches = matches_at(batch.matches)
    for index in range(rows.shape[0]):
        match = rows[index]
        count = matches.seats[match]
        world = world_at(batch.bank[matches.map_index[match]])
        agents = agents_of(batch.agents, match, count)
        supplies = supplies_of(batch.supplies, match, matches.slots[match])
        game = Game(world, agents, supplies, matches, match, rules_from(batch.rules))
        seen = seen_of(batch.seen, match, count)
        index_agents(game)
        for place in range(seats.shape[0]):
            if seats[place] < count:
                find_seen(game, seats[place], seen)


def compile_matches() -> None:
    """Compile the kernel that plays matches, or load it from the cache."""
    rows, actions = np.zeros(1, np.int64), np.zeros((1, 1, 1), np.float32)
    specialize(play_batch, _TABLE, rows, actions, 1, False)
