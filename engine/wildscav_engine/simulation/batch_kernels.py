"""The kernels that ``Batch`` calls: they access its arrays through address tables."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import Addresses, number_reader, row_reader
from wildscav_engine.compilation.kernel import kernel, specialize
from wildscav_engine.maps.bank import world_at
from wildscav_engine.simulation.state import allocate_state, matches_at
from wildscav_engine.simulation.step import play_step
from wildscav_engine.simulation.systems.visibility import allocate_seen, find_seen_in_match
from wildscav_engine.specs.rules import Rules

_EXAMPLE = allocate_state(1, 1, 1, 1, 1, 1)
# Kernels that return the arrays of one match from their address tables.
agents_of = row_reader(_EXAMPLE.agents)
supplies_of = row_reader(_EXAMPLE.supplies)
seen_of = row_reader(allocate_seen(1, 1))
rules_from = number_reader(Rules())


@kernel
def play_batch(
    bank: NDArray[np.int64],
    agents: Addresses,
    supplies: Addresses,
    every: Addresses,
    seen: Addresses,
    rows: NDArray[np.int64],
    actions: NDArray[np.float32],
    allowed: NDArray[np.bool_],
    frames_per_action: int,
    rules: NDArray[np.float64],
    is_reset: bool,
) -> None:
    """Begin the matches in some rows, or play one step of those that are not over.

    The actions are replaced by those that were played. One kernel does both, because beginning and playing
    share most of the code to compile.
    """
    matches = matches_at(every)
    for index in range(rows.shape[0]):
        match = rows[index]
        if not matches.over[match]:
            seats = matches.seats[match]
            play_step(
                world_at(bank[matches.map_index[match]]),
                agents_of(agents, match, seats),
                supplies_of(supplies, match, matches.slots[match]),
                matches,
                match,
                seen_of(seen, match, seats),
                actions[match][:seats],
                allowed,
                frames_per_action,
                rules_from(rules),
                is_reset,
            )


@kernel
def find_seen_in_batch(
    bank: NDArray[np.int64],
    agents: Addresses,
    supplies: Addresses,
    every: Addresses,
    seen: Addresses,
    rules: NDArray[np.float64],
) -> None:
    """Update what the agents of all matches see."""
    matches = matches_at(every)
    for match in range(matches.seats.shape[0]):
        seats = matches.seats[match]
        find_seen_in_match(
            world_at(bank[matches.map_index[match]]),
            agents_of(agents, match, seats),
            supplies_of(supplies, match, matches.slots[match]),
            matches,
            match,
            rules_from(rules),
            seen_of(seen, match, seats),
        )


def compile_matches() -> None:
    """Compile the kernel that plays matches, or load it from the cache."""
    table, rows, actions = np.zeros((1, 1), np.int64), np.zeros(1, np.int64), np.zeros((1, 1, 1), np.float32)
    allowed, rules = np.zeros(1, np.bool_), np.zeros(1)
    specialize(play_batch, table[None], *[table] * 4, rows, actions, allowed, 1, rules, False)
