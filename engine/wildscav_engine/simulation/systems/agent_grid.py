"""The grid of agents: a spatial index of the living agents of a match, by squares of the map.

With it, collisions, shots and visibility need not test all pairs of agents. The grid is rebuilt at the start
of each frame, so it lags behind by at most the distance that an agent moves in a frame, ``LAG``. It is
derived from the positions of the agents.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.linked_grid import Squares, link, square_of, squares_around, squares_over
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import Agents, Matches, squares_for
from wildscav_engine.specs.actions import MAX_WALK_SPEED
from wildscav_engine.specs.body import BODY_RADIUS
from wildscav_engine.specs.rules import FRAME

LAG = MAX_WALK_SPEED * FRAME + 1e-6  # m in x and in z that an agent may have moved since it was indexed

# m in x and in z: agents farther apart cannot touch in a frame.
TOUCH = 2.0 * BODY_RADIUS + 3.0 * MAX_WALK_SPEED * FRAME

_squares_for = kernel(squares_for)


class AgentGrid(NamedTuple):
    """The grid of agents of one match."""

    squares: Squares
    heads: NDArray[np.int32]  # (N,) seat + 1 of the first agent in each square, 0 = nobody
    links: NDArray[np.int32]  # (A,) seat + 1 of the next agent in the same square


@inlined_kernel
def agent_grid_of(world: World, agents: Agents, matches: Matches, match: int) -> AgentGrid:
    """Return the grid of a match."""
    squares = squares_over(world, _squares_for(agents.health.shape[0]))
    return AgentGrid(squares, matches.agent_squares[match], agents.next_in_square)


@kernel
def fill_grid(
    squares: Squares,
    position: NDArray[np.float64],
    health: NDArray[np.int32],
    heads: NDArray[np.int32],
    links: NDArray[np.int32],
) -> None:
    """Add all living agents to the lists of their squares, in ascending order of seats.

    Args:
        squares: The grid.
        position: (A, 3) m.
        health: (A,) hp.
        heads: (N,) written.
        links: (A,) written.
    """
    for square in range(squares.side * squares.side):
        heads[square] = 0
    for seat in range(health.shape[0] - 1, -1, -1):
        if health[seat] > 0:
            link(heads, links, square_of(squares, position[seat, 0], position[seat, 2]), seat)


@inlined_kernel
def index_agents(world: World, agents: Agents, matches: Matches, match: int) -> None:
    """Rebuild the grid of a match; a single agent needs none."""
    if agents.health.shape[0] > 1:
        squares, heads, links = agent_grid_of(world, agents, matches, match)
        fill_grid(squares, agents.position, agents.health, heads, links)


@kernel
def gather_near(
    squares: Squares,
    position: NDArray[np.float64],
    heads: NDArray[np.int32],
    links: NDArray[np.int32],
    seat: int,
    near: NDArray[np.int32],
) -> int:
    """Write the seats of agents that one agent may touch in a frame, and return their number.

    Args:
        squares: The squares of the grid.
        position: (A, 3) m.
        heads: (N,) the heads of the grid's lists.
        links: (A,) the links of the grid's lists.
        seat: The agent whose neighbours are found.
        near: (A,) their seats, written.
    """
    x, z = position[seat, 0], position[seat, 2]
    around = squares_around(squares, x, z, TOUCH + LAG)
    count = 0
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            other = heads[row * squares.side + column] - 1
            while other >= 0:
                is_near = abs(position[other, 0] - x) <= TOUCH and abs(position[other, 2] - z) <= TOUCH
                if is_near and other != seat:
                    near[count] = other
                    count += 1
                other = links[other] - 1
    return count


@inlined_kernel
def others_near(world: World, agents: Agents, matches: Matches, match: int, seat: int) -> int:
    """Write the seats near an agent into ``agents.near``, and return their number."""
    if agents.health.shape[0] == 1:
        return 0
    squares, heads, links = agent_grid_of(world, agents, matches, match)
    return gather_near(squares, agents.position, heads, links, seat, agents.near)
