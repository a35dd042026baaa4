"""Supply boxes: where they are placed, how agents pick them up, and what agents drop when they die.

The outdoor part of a wave uses a square grid over the map. Each grid point on open ground gets a box with the
probability richness · exp(-d² / 2r²), where d is its distance from the wave's center and r the radius of the
heat map. Open ground means the map's outdoor locations or, if the grid is finer than those, every whole metre
of it. The indoor points are indoor locations 5 m apart; each gets a box with the probability indoor richness,
wherever it is. There are thus fewer boxes indoors, but they hold more.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import exponential
from wildscav_engine.arithmetic.random_numbers import Stream, Word, integer_in, uniform
from wildscav_engine.compilation.kernel import array_kernel, inlined_kernel, kernel
from wildscav_engine.geometry.linked_grid import (
    Squares,
    link,
    square_of,
    squares_around,
    squares_over,
    unlink,
)
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.simulation.digest import digest_box
from wildscav_engine.simulation.state import BOX_SQUARES, Agents, Game, Matches, Supplies
from wildscav_engine.specs.actions import Field

BOX_SQUARE = 16.0  # m, minimum side of a square in the grid of boxes


@array_kernel
def choose_outdoor(
    outdoor: NDArray[np.float64],
    spacing: float,
    center_x: float,
    center_z: float,
    radius: float,
    richness: float,
    seed: Word,
    wave: int,
) -> NDArray[np.int64]:
    """Return (N,) the indices of the outdoor locations (O, 3) m that get a box in a wave, ascending.

    The first location in a square of the grid represents its grid point. The spacing of the grid is in m, as
    are the center and the radius (a standard deviation) of the heat map; the richness is its center's, in %.
    """
    lowest_x, lowest_z = np.floor(outdoor[:, 0].min() / spacing), np.floor(outdoor[:, 2].min() / spacing)
    columns = int(np.floor(outdoor[:, 0].max() / spacing) - lowest_x) + 1
    rows = int(np.floor(outdoor[:, 2].max() / spacing) - lowest_z) + 1
    taken = np.zeros(rows * columns, np.bool_)
    chosen = np.empty(outdoor.shape[0], np.int64)
    count = 0
    for place in range(outdoor.shape[0]):
        column = int(np.floor(outdoor[place, 0] / spacing) - lowest_x)
        square = int(np.floor(outdoor[place, 2] / spacing) - lowest_z) * columns + column
        if taken[square]:
            continue
        taken[square] = True
        dx, dz = outdoor[place, 0] - center_x, outdoor[place, 2] - center_z
        heat = exponential(-(dx * dx + dz * dz) / (2.0 * radius * radius))
        if uniform(seed, Stream.SUPPLY_PLACE, wave, 0, square) < richness / 100.0 * heat:
            chosen[count] = place
            count += 1
    return chosen[:count]


@array_kernel
def choose_indoor(places: int, richness: float, seed: Word, wave: int) -> NDArray[np.int64]:
    """Return (N,) the indices of the indoor points that get a box in a wave, ascending."""
    chosen = np.empty(places, np.int64)
    count = 0
    for place in range(places):
        if uniform(seed, Stream.SUPPLY_PLACE, wave, 1, place) < richness / 100.0:
            chosen[count] = place
            count += 1
    return chosen[:count]


@kernel
def fill_boxes(
    places: NDArray[np.float64],
    low: int,
    high: int,
    appears: int,
    seed: Word,
    first: int,
    position: NDArray[np.float32],
    quantity: NDArray[np.int32],
    appearance: NDArray[np.int32],
) -> None:
    """Write boxes at places (N, 3) m, with random quantities, into slots from ``first`` on.

    They are present from the frame ``appears`` on.
    """
    for index in range(places.shape[0]):
        slot = first + index
        for axis in range(3):
            position[slot, axis] = places[index, axis]
        quantity[slot] = integer_in(low, high, seed, Stream.SUPPLY_QUANTITY, 0, 0, slot)
        appearance[slot] = appears


@inlined_kernel
def is_present(supplies: Supplies, slot: int, frame: int) -> bool:
    """Return whether a slot holds a box that is present in a frame."""
    return bool(supplies.quantity[slot] > 0 and supplies.appears[slot] <= frame)


@inlined_kernel
def squares_of_boxes(world: World) -> Squares:
    """Return the grid of the boxes on a map."""
    return squares_over(world, min(BOX_SQUARES, max(1, int(world.water.shape[1] * CELL / BOX_SQUARE))))


@kernel
def index_boxes(world: World, supplies: Supplies, matches: Matches, match: int) -> None:
    """Add all boxes to the lists of their squares, including those that appear later."""
    squares, heads = squares_of_boxes(world), matches.box_squares[match]
    for square in range(heads.shape[0]):
        heads[square] = 0
    for slot in range(supplies.quantity.shape[0] - 1, -1, -1):
        if supplies.quantity[slot] > 0:
            link(heads, supplies.next_in_square, _square_of_box(squares, supplies, slot), slot)


@inlined_kernel
def _square_of_box(squares: Squares, supplies: Supplies, slot: int) -> int:
    return square_of(squares, np.float64(supplies.position[slot, 0]), np.float64(supplies.position[slot, 2]))


@inlined_kernel
def squared_distance_to_box(agents: Agents, supplies: Supplies, seat: int, slot: int) -> float:
    """Return the squared distance in m² from an agent's soles to a box."""
    dx = supplies.position[slot, 0] - agents.position[seat, 0]
    dy = supplies.position[slot, 1] - agents.position[seat, 1]
    dz = supplies.position[slot, 2] - agents.position[seat, 2]
    return float(dx * dx + dy * dy + dz * dz)


@kernel
def nearest_box(game: Game, seat: int) -> int:
    """Return the slot of the nearest box within reach (3D distance from the soles), or -1.

    Of boxes at the same distance, the one in the first slot is returned.
    """
    agents, supplies, reach = game.agents, game.supplies, game.rules.pick_up_distance
    squares, heads = squares_of_boxes(game.world), game.matches.box_squares[game.match]
    around = squares_around(squares, agents.position[seat, 0], agents.position[seat, 2], reach)
    best, nearest, frame = -1, reach * reach, game.matches.frame[game.match]
    for row in range(around.south, around.north + 1):
        for column in range(around.west, around.east + 1):
            slot = heads[row * squares.side + column] - 1
            while slot >= 0:
                if is_present(supplies, slot, frame):
                    distance = squared_distance_to_box(agents, supplies, seat, slot)
                    if distance < nearest or (distance == nearest and (best < 0 or slot < best)):
                        best, nearest = slot, distance
                slot = supplies.next_in_square[slot] - 1
    return best


@inlined_kernel
def pick_up(game: Game, actions: NDArray[np.float32]) -> None:
    """Let each living agent that picks up take the nearest box in reach, in the order of the frame."""
    agents = game.agents
    if game.supplies.quantity.shape[0] == 0:
        return
    for turn in range(agents.turns.shape[0]):
        seat = agents.turns[turn]
        if actions[seat, Field.PICK_UP] != 0.0 and agents.health[seat] > 0:
            _take_nearest(game, seat)


@kernel
def _take_nearest(game: Game, seat: int) -> None:
    agents, supplies, matches, match = game.agents, game.supplies, game.matches, game.match
    slot = nearest_box(game, seat)
    if slot < 0:
        return
    agents.supplies[seat] += supplies.quantity[slot]
    agents.picked_up[seat] += supplies.quantity[slot]
    agents.gained[seat] += supplies.quantity[slot]
    supplies.quantity[slot] = 0
    square = _square_of_box(squares_of_boxes(game.world), supplies, slot)
    unlink(matches.box_squares[match], supplies.next_in_square, square, slot)
    matches.digest[match] = digest_box(matches.digest[match], supplies, slot)


@kernel
def drop_supplies(game: Game, seat: int) -> None:
    """Drop a share of an agent's supplies, rounded down, at its position.

    If no slot is free, the agent keeps them, so that no supplies are lost.
    """
    agents, supplies, matches, match = game.agents, game.supplies, game.matches, game.match
    dropped = int(np.floor(agents.supplies[seat] * game.rules.supply_loss))
    if dropped == 0:
        return
    for slot in range(supplies.quantity.shape[0] - 1, -1, -1):
        if supplies.quantity[slot] == 0:
            agents.supplies[seat] -= dropped
            squares, heads = squares_of_boxes(game.world), matches.box_squares[match]
            # A box that a test emptied may still be listed.
            unlink(heads, supplies.next_in_square, _square_of_box(squares, supplies, slot), slot)
            supplies.quantity[slot] = dropped
            for axis in range(3):
                supplies.position[slot, axis] = agents.position[seat, axis]
            supplies.appears[slot] = matches.frame[match]
            supplies.serial[slot] = matches.next_serial[match]
            matches.next_serial[match] += 1
            link(heads, supplies.next_in_square, _square_of_box(squares, supplies, slot), slot)
            matches.digest[match] = digest_box(matches.digest[match], supplies, slot)
            return


@kernel
def team_supplies(teams: NDArray[np.int32], supplies: NDArray[np.int32], team: int) -> int:
    """Return the supplies that a team carries, by (A,) the teams and (A,) the supplies of seats."""
    total = 0
    for seat in range(teams.shape[0]):
        if teams[seat] == team:
            total += supplies[seat]
    return total
