"""The state of a batch of matches: structures of arrays with a leading match axis.

There are B matches, with at most A seats and at most S slots for supply boxes each. Kernels work on slices of
one match, which have the same names and no B axis. The classes here are the one table of what a match
remembers: the type of a field says its dtype, axes and first value, and from that follow the arrays of a
batch, how they grow, and what a snapshot keeps of them.
"""

import functools
import math
from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import Annotated, Any, NamedTuple, TypeAlias, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.passed_tables import pass_as_table
from wildscav_engine.compilation.tables.array_tables import ArrayTable, reader, values_reader
from wildscav_engine.geometry.world import World
from wildscav_engine.specs.rules import Rules

NOBODY = -1  # in place of a seat
NOT_ELIMINATED = -1  # in place of the frame of an elimination
MEMORY = 12  # numbers in a robot's memory
MAX_SQUARES = 64  # along each side of a map, in the grid of agents
BOX_SQUARES = 16  # maximum along each side of a map, in the grid of boxes


class Ending(IntEnum):
    """Why a match is over."""

    NONE = 0  # it is not over
    TIME_UP = 1
    GOAL = 2  # the target is reached, or enough supplies are collected
    LAST_STANDING = 3  # at most one team is left


class Extent(IntEnum):
    """The part of an array's second axis that belongs to a match."""

    SEATS = 0
    SLOTS = 1
    PHASES = 2
    PLACES = 3
    WAVES = 4
    WHOLE = 5
    NOTHING = 6  # derived data, which is computed anew


class Axes(NamedTuple):
    """The axes of an array after that of the matches, and its first value."""

    extent: Extent = Extent.WHOLE  # the second axis; WHOLE if there is none, or if its length is in ``inner``
    inner: tuple[int, ...] = ()  # lengths of the axes after it
    fill: int = 0  # the value of every item in a new batch


Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int32]
# Of each seat:
Flag: TypeAlias = Annotated[NDArray[np.bool_], Axes(Extent.SEATS)]  # (B, A)
Count: TypeAlias = Annotated[Integers, Axes(Extent.SEATS)]  # (B, A)
Seat: TypeAlias = Annotated[Integers, Axes(Extent.SEATS, (), NOBODY)]  # (B, A)
Number: TypeAlias = Annotated[Floats, Axes(Extent.SEATS)]  # (B, A)
Vector: TypeAlias = Annotated[Floats, Axes(Extent.SEATS, (3,))]  # (B, A, 3) east, up, north
# Of each slot for a box, and of each match:
SlotCount: TypeAlias = Annotated[Integers, Axes(Extent.SLOTS)]  # (B, S)
MatchCount: TypeAlias = Annotated[NDArray[np.int64], Axes()]  # (B,)
MatchFlag: TypeAlias = Annotated[NDArray[np.bool_], Axes()]  # (B,)
MatchWord: TypeAlias = Annotated[NDArray[np.uint64], Axes()]  # (B,)


@pass_as_table
class Agents(NamedTuple):
    """The state of the agents."""

    present: Flag  # whether the match has this seat
    team: Count
    robot: Count  # the number of the robot that fills the seat, 0 for none
    memory: Annotated[Floats, Axes(Extent.SEATS, (MEMORY,))]  # numbers that a robot remembers
    start: Vector  # m, where it started
    # Equipment at the start and after each respawn.
    full_health: Count  # hp
    clip_size: Count  # rounds
    full_spare_ammo: Count  # rounds
    shot_damage: Count  # hp per hit
    position: Vector  # m, soles of the feet, y up
    velocity: Vector  # m/s, actual velocity in the last frame
    yaw: Number  # degrees in (-180, 180], 0 faces +z, grows clockwise from above
    pitch: Number  # degrees in [-90, 90], positive looks down
    on_ground: Flag
    in_water: Flag
    walked: Number  # m, horizontal distance walked so far
    walk_velocity: Annotated[Floats, Axes(Extent.SEATS, (2,))]  # m/s east and north, wanted in this step
    reached: Flag  # whether it is at the target
    knows_target: Flag  # whether the target is not hidden or its team has found it
    health: Count  # hp, 0 = dead
    respawn_left: Count  # frames until a dead agent respawns, 0 if it never does
    eliminated: Annotated[Integers, Axes(Extent.SEATS, (), NOT_ELIMINATED)]  # the frame, or NOT_ELIMINATED
    placement: Count  # of its team, 1 = best, 0 while the team is in the match
    invincible_left: Count  # frames
    clip: Count  # rounds in the weapon
    spare_ammo: Count  # rounds outside the weapon
    reload_left: Count  # frames until a reload is done, 0 = not reloading
    fire_left: Count  # frames until the weapon can fire again
    supplies: Count  # carried
    picked_up: Count  # supplies picked up since the start
    kills: Count
    deaths: Count
    shots: Count
    hits: Count
    # What happened in the current step; cleared when the next one begins.
    fired: Flag
    shot_end: Vector  # m, where the last shot ended
    hit_seat: Seat  # the seat that it hit, or NOBODY
    hit_by_seat: Seat  # the seat that hit it, or NOBODY
    damage: Count  # hp to be lost at the end of the frame
    gained: Count  # supplies picked up in this step
    # Derived data: the seats in the order of the frame (``systems/turn_order.py``), and the grid of agents
    # (``systems/agent_grid.py``).
    turns: Count
    next_in_square: Count  # seat + 1 of the next agent in the same square, 0 = none
    near: Count  # seats near the agent that is moving


# What each agent is equipped with, by the rule that says it for all.
EQUIPMENT = {
    "full_health": "start_health",
    "clip_size": "clip_size",
    "full_spare_ammo": "spare_ammo",
    "shot_damage": "shot_damage",
}
# The facts about an agent in the digest of a match, in this order; further ones come last. The digest also
# contains the memory of robots and where shots ended.
DIGESTED_NUMBERS = ("position", "walked", "velocity", "yaw", "pitch")
DIGESTED_FLAGS = ("on_ground", "in_water", "reached", "knows_target", "fired")  # bits of one number
DIGESTED_COUNTS = (
    *(
        "health",
        "respawn_left",
        "invincible_left",
        "clip",
        "spare_ammo",
        "reload_left",
        "fire_left",
        "supplies",
    ),
    *("picked_up", "kills", "deaths", "shots", "hits", "gained", "hit_seat", "hit_by_seat", "placement"),
    *("eliminated", DIGESTED_FLAGS, "damage"),
)


@pass_as_table
class Supplies(NamedTuple):
    """The supply boxes, including those of later waves and those dropped by agents."""

    position: Annotated[NDArray[np.float32], Axes(Extent.SLOTS, (3,))]  # m, on the ground or floor
    quantity: SlotCount  # supplies in the box, 0 = taken or a free slot
    appears: SlotCount  # the frame from which on it is present
    serial: SlotCount  # number of the box, unique in its match
    next_in_square: SlotCount  # slot + 1 of the next box in the same square, 0 = none


@pass_as_table
class Matches(NamedTuple):
    """The state of whole matches."""

    map_index: MatchCount  # in the map bank
    seats: MatchCount  # number of seats; the rest is padding
    slots: MatchCount  # number of slots for boxes; the rest is padding
    seed: MatchWord
    frame: MatchCount  # frames played
    frame_limit: MatchCount
    step: MatchCount  # steps played
    over: MatchFlag
    ending: MatchCount  # why it is over, an Ending
    respawns: Annotated[NDArray[np.bool_], Axes(fill=1)]  # whether agents respawn
    respawns_at_start: MatchFlag  # whether they respawn where they started
    teams: MatchCount  # number of teams
    teams_left: MatchCount  # number of teams that are not eliminated
    members_left: Count  # number of seats of each team that are not eliminated
    supply_goal: MatchCount  # supplies that a team must carry to end the match, 0 = no goal
    target: Annotated[Floats, Axes(inner=(3,))]  # m
    has_target: MatchFlag  # whether reaching the target ends the match
    reached_by: Annotated[NDArray[np.int64], Axes(fill=NOBODY)]  # the first seat that reached it, or NOBODY
    next_serial: MatchCount  # for the next box dropped
    # Phases of the safe zone: the frames in which shrinking starts and ends, x, z and radius in m before it,
    # x, z and radius after it, and hp per second outside.
    zone: Annotated[Floats, Axes(Extent.PHASES, (9,))]
    phases: MatchCount  # number of phases; the rest is padding
    # The frame in which the hot spot comes to a place, x, z in m.
    hot_spots: Annotated[Floats, Axes(Extent.PLACES, (3,))]
    places: MatchCount  # number of places of the hot spot; the rest is padding
    # The frame in which a wave of supplies appears, x, z in m.
    wave_centers: Annotated[Floats, Axes(Extent.WAVES, (3,))]
    waves: MatchCount  # number of waves, the hot spot's included; the rest is padding
    digest: MatchWord  # of all states and actions so far
    # Seat + 1 of the first agent in each square, 0 = nobody; slot + 1 of the first box, 0 = none.
    agent_squares: Annotated[Integers, Axes(Extent.NOTHING)]
    box_squares: Annotated[Integers, Axes(inner=(BOX_SQUARES**2,))]


class Game(NamedTuple):
    """One match of a batch, as kernels play it."""

    world: World
    agents: Agents  # of the match, as are the boxes
    supplies: Supplies
    matches: Matches  # all of the batch
    match: int  # its index among them
    rules: Rules


class _Parts(NamedTuple):
    agents: Agents
    supplies: Supplies
    matches: Matches


class State(_Parts):
    """The whole mutable state of a batch of matches: ``agents``, ``supplies`` and ``matches``."""

    def __reduce__(self) -> tuple[type["State"], tuple[Any, ...]]:
        """Copy and pickle only the arrays: the copies have other addresses."""
        return State, tuple(self)

    @functools.cached_property
    def tables(self) -> tuple[ArrayTable, ArrayTable, ArrayTable]:
        """The array tables of the three, for kernels."""
        return ArrayTable(self.agents), ArrayTable(self.supplies), ArrayTable(self.matches)


def squares_for(seats: int) -> int:
    """Return the number of squares along each side of the grid of agents, for about two agents per square."""
    return min(MAX_SQUARES, max(1, int(math.sqrt(seats * 0.5))))


Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


@functools.cache
def axes_of(kind: type[tuple[Any, ...]]) -> Mapping[str, tuple[type[np.generic], Axes]]:
    """Return the dtype and the axes of every field of a class of arrays, by its name."""
    found = {}
    for name, hint in get_type_hints(kind, include_extras=True).items():
        dtype, axes = get_args(hint)
        while inner := get_args(dtype):  # NDArray[T], or what it stands for: ndarray[shape, dtype[T]]
            dtype = inner[-1]
        found[name] = dtype, axes
    return found


def allocate(kind: type[Arrays], matches: int, lengths: Sequence[int]) -> Arrays:
    """Return new arrays for all fields of a class annotated with ``Axes``; ``lengths`` are by ``Extent``."""
    arrays = []
    for dtype, (extent, inner, fill) in axes_of(kind).values():
        second = () if extent == Extent.WHOLE else (lengths[extent],)
        array = np.zeros((matches, *second, *inner), dtype)
        if fill:
            array[...] = fill
        arrays.append(array)
    return kind(*arrays)


def allocate_state(
    matches: int, seats: int, slots: int, phases: int = 0, places: int = 0, waves: int = 0
) -> State:
    """Return a state of zeros, without agents and boxes."""
    lengths = seats, slots, phases, places, waves, 0, squares_for(seats) ** 2
    return State(
        allocate(Agents, matches, lengths),
        allocate(Supplies, matches, lengths),
        allocate(Matches, matches, lengths),
    )


def copied(arrays: Any) -> Any:
    """Return a NamedTuple of arrays with copies of all of them."""
    return type(arrays)(*(array.copy() for array in arrays))


def with_room(state: State, slots: int, phases: int, places: int, waves: int) -> State:
    """Return a state with room for so much in each match: the same state if it is large enough.

    Only arrays that are too small are replaced. Those of boxes grow by a quarter more than needed, so that
    this happens rarely.
    """
    if slots > state.supplies.quantity.shape[1]:
        slots += slots // 4
    room = {Extent.SLOTS: slots, Extent.PHASES: phases, Extent.PLACES: places, Extent.WAVES: waves}
    supplies, matches = _with_room(state.supplies, room), _with_room(state.matches, room)
    if supplies is state.supplies and matches is state.matches:
        return state
    return State(state.agents, supplies, matches)


def _with_room(arrays: Arrays, room: Mapping[Extent, int]) -> Arrays:
    """Return the same arrays, those replaced whose second axis is too short."""
    short = {
        name: _widened(array, room[axes.extent])
        for array, (name, (_, axes)) in zip(arrays, axes_of(type(arrays)).items(), strict=True)
        if axes.extent in room and array.shape[1] < room[axes.extent]
    }
    named: Any = arrays
    wide: Arrays = named._replace(**short) if short else arrays
    return wide


def _widened(array: NDArray[Any], room: int) -> NDArray[Any]:
    """Return a copy of an array whose second axis is longer, with zeros at its end."""
    wide = np.zeros((array.shape[0], room, *array.shape[2:]), array.dtype)
    wide[:, : array.shape[1]] = array
    return wide


_EXAMPLE = allocate_state(1, 1, 1, 1, 1, 1)
# Kernels that return the arrays of all matches from their address tables.
agents_at = reader(_EXAMPLE.agents)
supplies_at = reader(_EXAMPLE.supplies)
matches_at = reader(_EXAMPLE.matches)
# A kernel that gathers what the digest contains of a seat.
digested = values_reader(_EXAMPLE.agents, (*DIGESTED_NUMBERS, *DIGESTED_COUNTS))
