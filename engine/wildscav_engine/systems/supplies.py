"""Supply boxes: where they are put, how they are picked up, and what a dead agent leaves behind.

An outdoor wave looks at a square grid over the map. A grid point on open ground gets a box with probability
richness · exp(-d² / 2r²), d being its distance from the wave's center and r the heat map's radius. Indoor
points are indoor locations 5 m apart; each gets a box with probability indoor richness, wherever it is. So
there are fewer boxes indoors, and what they hold is more.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.actions import Field
from wildscav_engine.kernel import array_kernel, kernel
from wildscav_engine.rng import Stream, Word, integer_in, uniform
from wildscav_engine.rules import Rules
from wildscav_engine.state import Agents, Matches, Supplies
from wildscav_engine.systems.turns import Turns, seat_at
from wildscav_engine.trig import exponential


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
    """Return which outdoor locations get a box in a wave.

    Args:
        outdoor: (O, 3) m.
        spacing: m, of the grid; the first location found in a grid square stands for its point.
        center_x: m, of the heat map.
        center_z: m.
        radius: m, its standard deviation.
        richness: Percent at the center.
        seed: Of the match.
        wave: Number of the wave.

    Returns:
        (N,) indices of locations, ascending.
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
    position: NDArray[np.float64],
    quantity: NDArray[np.int32],
    appearance: NDArray[np.int32],
) -> None:
    """Put boxes with random quantities into slots from ``first`` on.

    Args:
        places: (N, 3) m.
        low: Least quantity.
        high: Greatest.
        appears: Frame from which they are there.
        seed: Of the match.
        first: Slot of the first box.
        position: (S, 3) m, written; the other two are (S,).
        quantity: Written.
        appearance: Written.
    """
    for index in range(places.shape[0]):
        slot = first + index
        for axis in range(3):
            position[slot, axis] = places[index, axis]
        quantity[slot] = integer_in(low, high, seed, Stream.SUPPLY_QUANTITY, 0, 0, slot)
        appearance[slot] = appears


@kernel
def is_there(supplies: Supplies, slot: int, frame: int) -> bool:
    """Return whether a slot holds a box in this frame."""
    return bool(supplies.quantity[slot] > 0 and supplies.appears[slot] <= frame)


@kernel
def nearest_box(agents: Agents, supplies: Supplies, seat: int, frame: int, reach: float) -> int:
    """Return the slot of the nearest box within reach (3D, from the soles), or -1."""
    best, nearest = -1, reach * reach
    for slot in range(supplies.quantity.shape[0]):
        if is_there(supplies, slot, frame):
            dx = supplies.position[slot, 0] - agents.position[seat, 0]
            dy = supplies.position[slot, 1] - agents.position[seat, 1]
            dz = supplies.position[slot, 2] - agents.position[seat, 2]
            distance = dx * dx + dy * dy + dz * dz
            if distance < nearest or (distance == nearest and best < 0):
                best, nearest = slot, distance
    return best


@kernel
def pick_up(
    agents: Agents,
    supplies: Supplies,
    actions: NDArray[np.float32],
    turns: Turns,
    frame: int,
    rules: Rules,
) -> None:
    """Let every living agent that wants to pick up take the nearest box in reach, in the frame's order."""
    for turn in range(turns.seats):
        seat = seat_at(turns, turn)
        if agents.health[seat] <= 0 or actions[seat, Field.PICK_UP] == 0.0:
            continue
        slot = nearest_box(agents, supplies, seat, frame, rules.pick_up_distance)
        if slot >= 0:
            agents.supplies[seat] += supplies.quantity[slot]
            agents.picked_up[seat] += supplies.quantity[slot]
            agents.gained[seat] += supplies.quantity[slot]
            supplies.quantity[slot] = 0


@kernel
def drop_supplies(
    agents: Agents, supplies: Supplies, matches: Matches, match: int, seat: int, share: float
) -> None:
    """Leave a share of an agent's supplies, rounded down, where it died.

    If no slot is free, it keeps them: nothing is ever lost.
    """
    dropped = int(np.floor(agents.supplies[seat] * share))
    if dropped == 0:
        return
    for slot in range(supplies.quantity.shape[0] - 1, -1, -1):
        if supplies.quantity[slot] == 0:
            agents.supplies[seat] -= dropped
            supplies.quantity[slot] = dropped
            for axis in range(3):
                supplies.position[slot, axis] = agents.position[seat, axis]
            supplies.appears[slot] = matches.frame[match]
            supplies.serial[slot] = matches.next_serial[match]
            matches.next_serial[match] += 1
            return
