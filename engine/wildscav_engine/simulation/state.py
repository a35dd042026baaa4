"""The state of a batch of matches: structures of arrays with a leading match axis.

There are B matches, with at most A seats and at most S slots for supply boxes each. Kernels work on slices of
one match, which have the same names and no B axis.
"""

import math
from enum import IntEnum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import ArrayTable, reader

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


class Agents(NamedTuple):
    """The state of the agents."""

    present: NDArray[np.bool_]  # (B, A) whether the match has this seat
    team: NDArray[np.int32]  # (B, A)
    robot: NDArray[np.int32]  # (B, A) the number of the robot that fills the seat, 0 for none
    memory: NDArray[np.float64]  # (B, A, 12) numbers that a robot remembers
    start: NDArray[np.float64]  # (B, A, 3) m, where it started
    # Equipment at the start and after each respawn.
    full_health: NDArray[np.int32]  # (B, A) hp
    clip_size: NDArray[np.int32]  # (B, A) rounds
    full_spare_ammo: NDArray[np.int32]  # (B, A) rounds
    shot_damage: NDArray[np.int32]  # (B, A) hp per hit
    position: NDArray[np.float64]  # (B, A, 3) m, soles of the feet, y up
    velocity: NDArray[np.float64]  # (B, A, 3) m/s, actual velocity in the last frame
    yaw: NDArray[np.float64]  # (B, A) degrees in (-180, 180], 0 faces +z, grows clockwise from above
    pitch: NDArray[np.float64]  # (B, A) degrees in [-90, 90], positive looks down
    on_ground: NDArray[np.bool_]  # (B, A)
    in_water: NDArray[np.bool_]  # (B, A)
    walked: NDArray[np.float64]  # (B, A) m, horizontal distance walked so far
    walk_velocity: NDArray[np.float64]  # (B, A, 2) m/s east and north, wanted in this step
    reached: NDArray[np.bool_]  # (B, A) whether it is at the target
    knows_target: NDArray[np.bool_]  # (B, A) whether the target is not hidden or its team has found it
    health: NDArray[np.int32]  # (B, A) hp, 0 = dead
    respawn_left: NDArray[np.int32]  # (B, A) frames until a dead agent respawns, 0 if it never does
    eliminated: NDArray[np.int32]  # (B, A) the frame of its elimination, or NOT_ELIMINATED
    placement: NDArray[np.int32]  # (B, A) of its team, 1 = best, 0 while the team is in the match
    invincible_left: NDArray[np.int32]  # (B, A) frames
    clip: NDArray[np.int32]  # (B, A) rounds in the weapon
    spare_ammo: NDArray[np.int32]  # (B, A) rounds outside the weapon
    reload_left: NDArray[np.int32]  # (B, A) frames until a reload is done, 0 = not reloading
    fire_left: NDArray[np.int32]  # (B, A) frames until the weapon can fire again
    supplies: NDArray[np.int32]  # (B, A) carried
    picked_up: NDArray[np.int32]  # (B, A) supplies picked up since the start
    kills: NDArray[np.int32]  # (B, A)
    deaths: NDArray[np.int32]  # (B, A)
    shots: NDArray[np.int32]  # (B, A)
    hits: NDArray[np.int32]  # (B, A)
    # What happened in the current step; cleared when the next one begins.
    fired: NDArray[np.bool_]  # (B, A)
    shot_end: NDArray[np.float64]  # (B, A, 3) m, where the last shot ended
    hit_seat: NDArray[np.int32]  # (B, A) the seat that it hit, or NOBODY
    hit_by_seat: NDArray[np.int32]  # (B, A) the seat that hit it, or NOBODY
    damage: NDArray[np.int32]  # (B, A) hp to be lost at the end of the frame
    gained: NDArray[np.int32]  # (B, A) supplies picked up in this step
    # Derived data: the seats in the order of the frame (``systems/turn_order.py``), and the grid of agents
    # (``systems/agent_grid.py``).
    turns: NDArray[np.int32]  # (B, A)
    next_in_square: NDArray[np.int32]  # (B, A) seat + 1 of the next agent in the same square, 0 = none
    near: NDArray[np.int32]  # (B, A) seats near the agent that is moving


class Supplies(NamedTuple):
    """The supply boxes, including those of later waves and those dropped by agents."""

    position: NDArray[np.float32]  # (B, S, 3) m, on the ground or floor
    quantity: NDArray[np.int32]  # (B, S) supplies in the box, 0 = taken or a free slot
    appears: NDArray[np.int32]  # (B, S) the frame from which on it is present
    serial: NDArray[np.int32]  # (B, S) number of the box, unique in its match
    next_in_square: NDArray[np.int32]  # (B, S) slot + 1 of the next box in the same square, 0 = none


class Matches(NamedTuple):
    """The state of whole matches."""

    map_index: NDArray[np.int64]  # (B,) in the map bank
    seats: NDArray[np.int64]  # (B,) number of seats; the rest of the A are padding
    slots: NDArray[np.int64]  # (B,) number of slots for boxes; the rest of the S are padding
    seed: NDArray[np.uint64]  # (B,)
    frame: NDArray[np.int64]  # (B,) frames played
    frame_limit: NDArray[np.int64]  # (B,)
    step: NDArray[np.int64]  # (B,) steps played
    over: NDArray[np.bool_]  # (B,)
    ending: NDArray[np.int64]  # (B,) why it is over, an Ending
    respawns: NDArray[np.bool_]  # (B,) whether agents respawn
    respawns_at_start: NDArray[np.bool_]  # (B,) whether they respawn where they started
    teams: NDArray[np.int64]  # (B,) number of teams
    teams_left: NDArray[np.int64]  # (B,) number of teams that are not eliminated
    members_left: NDArray[np.int32]  # (B, A) number of seats of each team that are not eliminated
    supply_goal: NDArray[np.int64]  # (B,) supplies that a team must carry to end the match, 0 = no goal
    target: NDArray[np.float64]  # (B, 3) m
    has_target: NDArray[np.bool_]  # (B,) whether reaching the target ends the match
    reached_by: NDArray[np.int64]  # (B,) the first seat that reached it, or NOBODY
    next_serial: NDArray[np.int64]  # (B,) for the next box dropped
    zone: NDArray[np.float64]  # (B, Z, 9) phases of the safe zone: the frames in which shrinking starts and
    # ends, x, z and radius in m before it, x, z and radius after it, and hp per second outside
    phases: NDArray[np.int64]  # (B,) number of phases; the rest of the Z are padding
    hot_spots: NDArray[np.float64]  # (B, H, 3) the frame in which the hot spot comes to a place, x, z in m
    places: NDArray[np.int64]  # (B,) number of places of the hot spot; the rest of the H are padding
    wave_centers: NDArray[np.float64]  # (B, W, 3) the frame in which a wave of supplies appears, x, z in m
    waves: NDArray[np.int64]  # (B,) number of waves, the hot spot's included; the rest of the W are padding
    digest: NDArray[np.uint64]  # (B,) of all states and actions so far
    agent_squares: NDArray[np.int32]  # (B, N) seat + 1 of the first agent in each square, 0 = nobody
    box_squares: NDArray[np.int32]  # (B, 256) slot + 1 of the first box in each square, 0 = none


class _Parts(NamedTuple):
    agents: Agents
    supplies: Supplies
    matches: Matches


class State(_Parts):
    """The whole mutable state of a batch of matches: ``agents``, ``supplies`` and ``matches``."""

    def __reduce__(self) -> tuple[type["State"], tuple[Any, ...]]:
        """Copy and pickle only the arrays: the copies have other addresses."""
        return State, tuple(self)

    @cached_property
    def tables(self) -> tuple[ArrayTable, ArrayTable, ArrayTable]:
        """The array tables of the three, for kernels."""
        return ArrayTable(self.agents), ArrayTable(self.supplies), ArrayTable(self.matches)


def squares_for(seats: int) -> int:
    """Return the number of squares along each side of the grid of agents, for about two agents per square."""
    return min(MAX_SQUARES, max(1, int(math.sqrt(seats * 0.5))))


def allocate_state(
    matches: int, seats: int, slots: int, phases: int = 0, places: int = 0, waves: int = 0
) -> State:
    """Return a state of zeros, without agents and boxes."""
    b, a, s = matches, seats, slots
    agents = Agents(
        present=np.zeros((b, a), np.bool_),
        team=np.zeros((b, a), np.int32),
        robot=np.zeros((b, a), np.int32),
        memory=np.zeros((b, a, MEMORY)),
        start=np.zeros((b, a, 3)),
        position=np.zeros((b, a, 3)),
        velocity=np.zeros((b, a, 3)),
        yaw=np.zeros((b, a)),
        pitch=np.zeros((b, a)),
        on_ground=np.zeros((b, a), np.bool_),
        in_water=np.zeros((b, a), np.bool_),
        walked=np.zeros((b, a)),
        walk_velocity=np.zeros((b, a, 2)),
        reached=np.zeros((b, a), np.bool_),
        knows_target=np.zeros((b, a), np.bool_),
        eliminated=np.full((b, a), NOT_ELIMINATED, np.int32),
        placement=np.zeros((b, a), np.int32),
        **{name: np.zeros((b, a), np.int32) for name in _COUNTS},
        fired=np.zeros((b, a), np.bool_),
        shot_end=np.zeros((b, a, 3)),
        hit_seat=np.full((b, a), NOBODY, np.int32),
        hit_by_seat=np.full((b, a), NOBODY, np.int32),
        damage=np.zeros((b, a), np.int32),
        gained=np.zeros((b, a), np.int32),
        turns=np.zeros((b, a), np.int32),
        next_in_square=np.zeros((b, a), np.int32),
        near=np.zeros((b, a), np.int32),
    )
    supplies = Supplies(
        position=np.zeros((b, s, 3), np.float32),
        quantity=np.zeros((b, s), np.int32),
        appears=np.zeros((b, s), np.int32),
        serial=np.zeros((b, s), np.int32),
        next_in_square=np.zeros((b, s), np.int32),
    )
    return State(agents, supplies, _allocate_matches(b, a, phases, places, waves))


_COUNTS = (
    *("full_health", "clip_size", "full_spare_ammo", "shot_damage"),
    *("health", "respawn_left", "invincible_left", "clip", "spare_ammo", "reload_left", "fire_left"),
    *("supplies", "picked_up", "kills", "deaths", "shots", "hits"),
)


def _allocate_matches(b: int, a: int, phases: int, places: int, waves: int) -> Matches:
    return Matches(
        map_index=np.zeros(b, np.int64),
        seats=np.zeros(b, np.int64),
        slots=np.zeros(b, np.int64),
        seed=np.zeros(b, np.uint64),
        frame=np.zeros(b, np.int64),
        frame_limit=np.zeros(b, np.int64),
        step=np.zeros(b, np.int64),
        over=np.zeros(b, np.bool_),
        ending=np.zeros(b, np.int64),
        respawns=np.ones(b, np.bool_),
        respawns_at_start=np.zeros(b, np.bool_),
        teams=np.zeros(b, np.int64),
        teams_left=np.zeros(b, np.int64),
        members_left=np.zeros((b, a), np.int32),
        supply_goal=np.zeros(b, np.int64),
        target=np.zeros((b, 3)),
        has_target=np.zeros(b, np.bool_),
        reached_by=np.full(b, NOBODY, np.int64),
        next_serial=np.zeros(b, np.int64),
        zone=np.zeros((b, phases, 9)),
        phases=np.zeros(b, np.int64),
        hot_spots=np.zeros((b, places, 3)),
        places=np.zeros(b, np.int64),
        wave_centers=np.zeros((b, waves, 3)),
        waves=np.zeros(b, np.int64),
        digest=np.zeros(b, np.uint64),
        agent_squares=np.zeros((b, squares_for(a) ** 2), np.int32),
        box_squares=np.zeros((b, BOX_SQUARES * BOX_SQUARES), np.int32),
    )


def copied(arrays: Any) -> Any:
    """Return a NamedTuple of arrays with copies of all of them."""
    return type(arrays)(*(array.copy() for array in arrays))


def with_room(state: State, slots: int, phases: int, places: int, waves: int) -> State:
    """Return a state with at least the given capacity: the same state if it is large enough.

    Only arrays that are too small are replaced. Those of boxes grow by a quarter more than needed, so that
    this happens rarely.

    Args:
        state: The state.
        slots: The number of boxes in each match.
        phases: The number of phases of the safe zone in each match.
        places: The number of places of the hot spot in each match.
        waves: The number of waves of supplies in each match.
    """
    supplies, matches = state.supplies, state.matches
    if slots > supplies.quantity.shape[1]:
        supplies = Supplies(*(_widened(array, slots + slots // 4) for array in supplies))
    if phases > matches.zone.shape[1]:
        matches = matches._replace(zone=_widened(matches.zone, phases))
    if places > matches.hot_spots.shape[1]:
        matches = matches._replace(hot_spots=_widened(matches.hot_spots, places))
    if waves > matches.wave_centers.shape[1]:
        matches = matches._replace(wave_centers=_widened(matches.wave_centers, waves))
    if supplies is state.supplies and matches is state.matches:
        return state
    return State(state.agents, supplies, matches)


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
