"""The species, sizes and shapes of plants and rocks, drawn by key."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.arithmetic.random_numbers import Stream, uniform
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.shapes import MAX_SIDES, RingStacks
from wildscav_engine.geometry.world import Kind

STREAM = int(Stream.VEGETATION)
SHAPES = 1000  # the first agent of draws for shapes; lower ones are for places

TRUNK, LEAVES, LEAFY, STONE = int(Kind.TRUNK), int(Kind.CROWN), int(Kind.BUSH), int(Kind.ROCK)

BROADLEAF, CONIFER, POPLAR, DEAD, BUSH, STEPPING_STONE, BLOCK, BOULDER = range(8)

# The columns of a spot, the row of one plant or rock.
X, Z = 0, 1  # m
GROUND, HIGHEST, LOWEST = 2, 3, 4  # m, of the ground: at its axis, under its crown, under its foot
SPECIES = 5
RADIUS, CROWN = 6, 7  # m, circumradius of its foot, and of its crown
HEIGHT = 8  # m: of a crown, from its bottom to its top; else above the ground
KEY, MEMBER = 9, 10  # key of the plant, and its number in its group
DRAWS = 11  # the first of the random numbers from 0 to 1 for its size, shape and group
COLUMNS = 30
SIZE, SHAPE, TURN, LIFT, SIDES, STRETCH_TURN, STRETCH, CORNERS = 11, 12, 13, 14, 15, 16, 17, 18
BESIDE, GROUP, MORE, HEDGE = 26, 27, 28, 29  # where it touches its group, and the properties of the group

CROWN_CLEARANCE = 2.4  # m between the ground and a crown
WIDEST_CROWN, WIDEST_ROCK = 2.9, 2.2  # m, radius
PARTS = 3  # greatest number of solids of a plant
ROOT = 0.3  # m that every plant reaches into the lowest ground under it


@kernel
def is_tree(species: float) -> bool:
    """Return whether a species has a trunk."""
    return species <= DEAD


@kernel
def is_rock(species: float) -> bool:
    """Return whether a species is a rock."""
    return species >= STEPPING_STONE


@kernel
def draw_size(seed: np.uint64, spot: NDArray[np.float64]) -> None:
    """Draw a plant's random numbers by its key and group number, and set its radius and height from them."""
    key, agent, species = int(spot[KEY]), SHAPES + int(spot[MEMBER]), int(spot[SPECIES])
    for column in range(DRAWS, COLUMNS):
        spot[column] = uniform(seed, STREAM, key, agent, column)
    size, shape = spot[SIZE], spot[SHAPE]
    spot[CROWN] = 0.0
    if species == BROADLEAF:
        spot[CROWN] = 1.6 + (WIDEST_CROWN - 1.6) * size
        spot[RADIUS], spot[HEIGHT] = 0.14 + 0.1 * spot[CROWN], spot[CROWN] * (1.25 + 0.45 * shape)
    elif species == CONIFER:
        spot[CROWN] = 1.2 + 0.9 * size
        spot[RADIUS], spot[HEIGHT] = 0.12 + 0.12 * spot[CROWN], spot[CROWN] * (2.8 + 1.0 * shape)
    elif species == POPLAR:
        spot[CROWN] = 0.7 + 0.4 * size
        spot[RADIUS], spot[HEIGHT] = 0.28, 5.5 + 4.0 * shape
    elif species == DEAD:
        spot[RADIUS], spot[HEIGHT] = 0.2 + 0.14 * size, 3.2 + 3.3 * shape
    elif species == BUSH:
        spot[RADIUS], spot[HEIGHT] = 0.6 + 0.6 * size, 0.6 + 0.45 * size + 0.45 * shape
    elif species == STEPPING_STONE:
        spot[RADIUS], spot[HEIGHT] = 0.9 + 0.4 * size, 0.3 + 0.18 * shape
    elif species == BLOCK:
        spot[RADIUS], spot[HEIGHT] = 1.0 + 0.6 * size, 0.7 + 0.35 * shape
    else:
        spot[RADIUS], spot[HEIGHT] = 1.35 + (WIDEST_ROCK - 1.35) * size, 1.5 + 0.9 * size + 0.6 * shape


@kernel
def grow(spots: NDArray[np.float64], count: int, stacks: RingStacks) -> int:
    """Write the shapes of the first ``count`` plants; return the number of shapes."""
    written = 0
    for number in range(count):
        spot = spots[number]
        if is_tree(spot[SPECIES]):
            written = _grow_tree(spot, stacks, written)
        elif spot[SPECIES] == BUSH:
            written = _grow_bush(spot, stacks, written)
        else:
            written = _lay_rock(spot, stacks, written)
    return written


@kernel
def _between(low: float, high: float, share: float) -> float:
    return low + (high - low) * share


@kernel
def _begin(stacks: RingStacks, row: int, kind: int, spot: NDArray[np.float64]) -> None:
    stacks.kind[row] = kind
    stacks.axis[row, 0], stacks.axis[row, 1] = spot[X], spot[Z]
    stacks.levels[row] = 0


@kernel
def _ring(stacks: RingStacks, row: int, height: float, scale: float) -> None:
    stacks.rings[row, stacks.levels[row], 0] = height
    stacks.rings[row, stacks.levels[row], 1] = scale
    stacks.levels[row] += 1


@kernel
def _round_outline(stacks: RingStacks, row: int, sides: int, turn: float) -> None:
    stacks.sides[row] = sides
    for corner in range(sides):
        yaw = turn + corner * 360.0 / sides
        stacks.outline[row, corner, 0], stacks.outline[row, corner, 1] = sine(yaw), cosine(yaw)


@kernel
def _rough_outline(spot: NDArray[np.float64], stacks: RingStacks, row: int) -> None:
    """Write an irregular outline whose incircle has at least 0.7 of the radius of its circumcircle."""
    sides = min(MAX_SIDES, 7 + int(2.0 * spot[SIDES]))
    stacks.sides[row] = sides
    turn, across = 360.0 * spot[STRETCH_TURN], _between(0.86, 1.0, spot[STRETCH])
    for corner in range(sides):
        yaw = (corner + _between(-0.15, 0.15, spot[CORNERS + corner])) * 360.0 / sides
        along, beside = cosine(yaw), across * sine(yaw)
        stacks.outline[row, corner, 0] = along * sine(turn) + beside * cosine(turn)
        stacks.outline[row, corner, 1] = along * cosine(turn) - beside * sine(turn)


# The rings of crowns: heights in shares of a crown's own, upwards, and widths in shares of its radius.
BROAD = ((0.0, 0.5), (0.3, 1.0), (0.65, 0.85), (1.0, 0.3))
SLENDER = ((0.0, 0.45), (0.25, 1.0), (0.6, 0.8), (1.0, 0.0))
CONE = ((0.0, 0.6), (0.1, 1.0), (1.0, 0.0))
LOWER_CONE, UPPER_CONE = ((0.0, 0.6), (0.1, 1.0), (0.62, 0.28)), ((0.4, 0.45), (0.47, 0.7), (1.0, 0.0))
WIDE_CONE = 1.45  # m, radius from which a conifer has two crowns above each other


@kernel
def _grow_tree(spot: NDArray[np.float64], stacks: RingStacks, row: int) -> int:
    """Write a tapering trunk with a crown of one or two solids; a dead tree has no crown."""
    species, crown, height = int(spot[SPECIES]), spot[CROWN], spot[HEIGHT]
    turn = 60.0 * spot[TURN]
    bottom = spot[HIGHEST] + CROWN_CLEARANCE + 0.8 * spot[LIFT]
    _begin(stacks, row, TRUNK, spot)
    _round_outline(stacks, row, 6, turn)
    _ring(stacks, row, spot[LOWEST] - ROOT, spot[RADIUS])
    if species == DEAD:
        _ring(stacks, row, spot[GROUND] + height, 0.3 * spot[RADIUS])
        return row + 1
    _ring(stacks, row, bottom + 0.5 * height, 0.55 * spot[RADIUS])
    row += 1
    if species == BROADLEAF:
        return _grow_crown(spot, stacks, row, 8, turn, bottom, BROAD)
    if species == POPLAR:
        return _grow_crown(spot, stacks, row, 6, turn, bottom, SLENDER)
    if crown < WIDE_CONE:
        return _grow_crown(spot, stacks, row, 6, turn, bottom, CONE)
    row = _grow_crown(spot, stacks, row, 6, turn, bottom, LOWER_CONE)
    return _grow_crown(spot, stacks, row, 6, turn + 30.0, bottom, UPPER_CONE)


@kernel
def _grow_crown(
    spot: NDArray[np.float64],
    stacks: RingStacks,
    row: int,
    sides: int,
    turn: float,
    bottom: float,
    rings: tuple[tuple[float, float], ...],
) -> int:
    _begin(stacks, row, LEAVES, spot)
    _round_outline(stacks, row, sides, turn)
    for rise, width in rings:
        _ring(stacks, row, bottom + rise * spot[HEIGHT], width * spot[CROWN])
    return row + 1


@kernel
def _grow_bush(spot: NDArray[np.float64], stacks: RingStacks, row: int) -> int:
    """Write a low dome."""
    ground, radius, height = spot[GROUND], spot[RADIUS], spot[HEIGHT]
    _begin(stacks, row, LEAFY, spot)
    _rough_outline(spot, stacks, row)
    _ring(stacks, row, spot[LOWEST] - ROOT, 0.8 * radius)
    _ring(stacks, row, ground + 0.35 * height, radius)
    _ring(stacks, row, ground + 0.75 * height, 0.74 * radius)
    _ring(stacks, row, ground + height, 0.34 * radius)
    return row + 1


@kernel
def _lay_rock(spot: NDArray[np.float64], stacks: RingStacks, row: int) -> int:
    """Write an irregular block with a level top at least 1 m across."""
    ground, radius, height = spot[GROUND], spot[RADIUS], spot[HEIGHT]
    _begin(stacks, row, STONE, spot)
    _rough_outline(spot, stacks, row)
    _ring(stacks, row, spot[LOWEST] - ROOT, radius)
    if spot[SPECIES] == STEPPING_STONE:
        # Upright, because a slowly walking body cannot get over a sloping side within a frame.
        _ring(stacks, row, ground + height, 0.985 * radius)
        return row + 1
    is_boulder = spot[SPECIES] == BOULDER
    top = _between(0.56, 0.72, spot[TURN]) if is_boulder else _between(0.78, 0.88, spot[TURN])
    _ring(stacks, row, ground + _between(0.45, 0.65, spot[LIFT]) * height, 0.95 * radius)
    _ring(stacks, row, ground + height, top * radius)
    return row + 1
