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
from wildscav_engine.simulation.state import Game, squares_for
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
def agent_grid_of(game: Game) -> AgentGrid:
    """Return the grid of a match."""
    squares = squares_over(game.world, _squares_for(game.agents.health.shape[0]))
    return AgentGrid(squares, game.matches.agent_squares[game.match], game.agents.next_in_square)


@kernel
def _fill_grid(grid: AgentGrid, position: NDArray[np.float64], health: NDArray[np.int32]) -> None:
    """Write the lists of all squares, with the living agents in ascending order of seats."""
    squares = grid.squares
    for square in range(squares.side * squares.side):
        grid.heads[square] = 0
    for seat in range(health.shape[0] - 1, -1, -1):
        if health[seat] > 0:
            link(grid.heads, grid.links, square_of(squares, position[seat, 0], position[seat, 2]), seat)


@inlined_kernel
def index_agents(game: Game) -> None:
    """Rebuild the grid of a match; a single agent needs none."""
    if game.agents.health.shape[0] > 1:
        _fill_grid(agent_grid_of(game), game.agents.position, game.agents.health)


@kernel
def gather_near(grid: AgentGrid, position: NDArray[np.float64], seat: int, near: NDArray[np.int32]) -> int:
    """Write (A,) the seats of agents that one agent may touch in a frame, and return their number."""
    squares, x, z = grid.squares, position[seat, 0], position[seat, 2]
    around = squares_around(squares, x, z, TOUCH + LAG)
    count = 0
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            other = grid.heads[row * squares.side + column] - 1
            while other >= 0:
                is_near = abs(position[other, 0] - x) <= TOUCH and abs(position[other, 2] - z) <= TOUCH
                if is_near and other != seat:
                    near[count] = other
                    count += 1
                other = grid.links[other] - 1
    return count


@inlined_kernel
def others_near(game: Game, seat: int) -> int:
    """Write the seats near an agent into ``agents.near``, and return their number."""
    if game.agents.health.shape[0] == 1:
        return 0
    return gather_near(agent_grid_of(game), game.agents.position, seat, game.agents.near)
