"""A batch: many matches played as one, serially or over threads. A single match is a batch of one."""

from collections.abc import Callable, Sequence

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.actions import FIELDS, Field, no_actions
from wildscav_engine.kernel import array_kernel, parallel_kernel
from wildscav_engine.maps import MapError, map_of
from wildscav_engine.maps.bank import MapBank, build_bank, world_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rules import Rules
from wildscav_engine.sensors.visibility import Seen, allocate_seen
from wildscav_engine.set_up import MatchSetupError, Setup, place_match, plan_match
from wildscav_engine.spec import MatchSpec
from wildscav_engine.state import Agents, Matches, Supplies, allocate_state
from wildscav_engine.step import play_step
from wildscav_engine.tracks import TRACKS


class Batch:
    """Matches of one track under the same rules; their maps, seeds, targets and time limits may differ."""

    def __init__(self, specs: Sequence[MatchSpec], maps: Sequence[GameMap] | None = None) -> None:
        """Set the matches up.

        Args:
            specs: One for each match.
            maps: One for each match, where they are at hand; else they are made.

        Raises:
            MatchSetupError: A match cannot be set up, or the specs cannot share a batch.
        """
        self.specs = tuple(specs)
        self.maps = tuple(maps) if maps is not None else _make_maps(self.specs)
        if len(self.maps) != len(self.specs):
            raise MatchSetupError(f"{len(self.maps)} maps are given for {len(self.specs)} matches")
        first = _shared(self.specs)
        self.track = TRACKS[first.track]
        self.rules = first.rules
        self.frames_per_action = first.frames_per_action
        self.allowed = np.array([field in self.track.fields for field in Field])
        self.setups: tuple[Setup, ...] = tuple(
            plan_match(spec, game_map) for spec, game_map in zip(self.specs, self.maps, strict=True)
        )
        seats = max(len(spec.seats) for spec in self.specs)
        slots = max(setup.slots for setup in self.setups)
        phases = max(len(setup.zone) for setup in self.setups)
        self.state = allocate_state(len(self.specs), seats, slots, phases)
        self.seen = allocate_seen(len(self.specs), seats)
        worlds = {id(game_map): game_map.world for game_map in self.maps}
        places = {key: index for index, key in enumerate(worlds)}
        self.bank = build_bank(tuple(worlds.values()))
        for index, setup in enumerate(self.setups):
            self.state.matches.map_index[index] = places[id(self.maps[index])]
            place_match(self.state, index, setup)
        nothing = no_actions(len(self.specs) * seats).reshape(len(self.specs), seats, FIELDS)
        self._play(play_batch, nothing, opening=True)

    def step(self, actions: ArrayLike, *, threads: int = 1) -> NDArray[np.float32]:
        """Play one step of every match that is not over.

        Args:
            actions: (B, A, FIELDS). Rows of robots are replaced by their own choices, fields outside the
                track's action set count as zero, and a row with a number that is not finite or a walk speed
                outside 0–10 m/s does nothing.
            threads: How many threads play. The outcome is the same, bit for bit.

        Returns:
            (B, A, FIELDS), the actions as they were played.

        Raises:
            ValueError: The actions have another shape or are no real numbers, or there are too few or too
                many threads.
        """
        rows = check_actions(actions, self.state.agents.present.shape)
        play = play_batch
        if threads != 1:
            numba.set_num_threads(threads)
            play = play_batch_in_threads
        return self._play(play, rows, opening=False)

    def _play(
        self, play: Callable[..., None], actions: NDArray[np.float32], *, opening: bool
    ) -> NDArray[np.float32]:
        """Open the matches or play one step, and return the actions as played."""
        held = self.frames_per_action
        play(self.bank, *self.state, self.seen, actions, self.allowed, held, self.rules, opening)
        return actions


def check_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Return a copy of some actions, having checked that they are what a kernel expects.

    Args:
        actions: Rows of FIELDS numbers.
        shape: What they must have before the last axis: (B, A), or (A,).

    Raises:
        ValueError: They have another shape, or are no real numbers.
    """
    rows = np.asarray(actions)
    if rows.shape != (*shape, FIELDS) or rows.dtype.kind not in "biuf":
        wanted = (*shape, FIELDS)
        raise ValueError(
            f"actions are {rows.dtype} of shape {rows.shape}, must be real numbers of shape {wanted}"
        )
    with np.errstate(over="ignore"):  # too large for 32 bits becomes infinite, which is no action
        return np.array(rows, np.float32, order="C")


def _make_maps(specs: Sequence[MatchSpec]) -> tuple[GameMap, ...]:
    """Return the map of every match.

    Raises:
        MatchSetupError: One cannot be made.
    """
    try:
        return tuple(map_of(spec.map) for spec in specs)
    except MapError as error:
        raise MatchSetupError(str(error)) from error


def _shared(specs: Sequence[MatchSpec]) -> MatchSpec:
    """Return the first spec, having checked that the others can share a batch with it.

    Raises:
        MatchSetupError: They cannot, or there is none.
    """
    if not specs:
        raise MatchSetupError("a batch needs at least one match")
    for field in ("track", "rules", "frames_per_action"):
        values = {getattr(spec, field) for spec in specs}
        if len(values) > 1:
            raise MatchSetupError(f"the matches of a batch must have the same {field}, not {values}")
    return specs[0]


@array_kernel
def agents_of(agents: Agents, match: int, seats: int) -> Agents:
    """Return one match's agents as views, without the padding."""
    return Agents(
        agents.present[match][:seats],
        agents.team[match][:seats],
        agents.robot[match][:seats],
        agents.memory[match][:seats],
        agents.position[match][:seats],
        agents.velocity[match][:seats],
        agents.yaw[match][:seats],
        agents.pitch[match][:seats],
        agents.on_ground[match][:seats],
        agents.in_water[match][:seats],
        agents.walked[match][:seats],
        agents.reached[match][:seats],
        agents.knows_target[match][:seats],
        agents.health[match][:seats],
        agents.respawn_left[match][:seats],
        agents.eliminated[match][:seats],
        agents.placement[match][:seats],
        agents.invincible_left[match][:seats],
        agents.clip[match][:seats],
        agents.spare_ammo[match][:seats],
        agents.reload_left[match][:seats],
        agents.fire_left[match][:seats],
        agents.supplies[match][:seats],
        agents.picked_up[match][:seats],
        agents.kills[match][:seats],
        agents.deaths[match][:seats],
        agents.shots[match][:seats],
        agents.hits[match][:seats],
        agents.fired[match][:seats],
        agents.shot_end[match][:seats],
        agents.hit_seat[match][:seats],
        agents.hit_by_seat[match][:seats],
        agents.damage[match][:seats],
        agents.gained[match][:seats],
    )


@array_kernel
def supplies_of(supplies: Supplies, match: int, slots: int) -> Supplies:
    """Return one match's boxes as views, without the padding."""
    return Supplies(
        supplies.position[match][:slots],
        supplies.quantity[match][:slots],
        supplies.appears[match][:slots],
        supplies.serial[match][:slots],
    )


@array_kernel
def seen_of(seen: Seen, match: int, seats: int) -> Seen:
    """Return what one match's agents see as views, without the padding."""
    return Seen(
        seen.agents[match][:seats],
        seen.agent_count[match][:seats],
        seen.agent_distance[match][:seats],
        seen.supplies[match][:seats],
        seen.supply_count[match][:seats],
        seen.supply_distance[match][:seats],
        seen.can_pick_up[match][:seats],
    )


def _play_batch(
    bank: MapBank,
    agents: Agents,
    supplies: Supplies,
    matches: Matches,
    seen: Seen,
    actions: NDArray[np.float32],
    allowed: NDArray[np.bool_],
    frames_per_action: int,
    rules: Rules,
    opening: bool,
) -> None:
    """Open every match, or play one step of those not over; the actions become what was played.

    Both are in one kernel, because they share most of what there is to compile.
    """
    for match in numba.prange(actions.shape[0]):
        if not matches.over[match]:
            play_step(
                world_of(bank, matches.map_index[match]),
                agents_of(agents, match, matches.seats[match]),
                supplies_of(supplies, match, matches.slots[match]),
                matches,
                match,
                seen_of(seen, match, matches.seats[match]),
                actions[match][: matches.seats[match]],
                allowed,
                frames_per_action,
                rules,
                opening,
            )


play_batch = array_kernel(_play_batch)
play_batch_in_threads = parallel_kernel(_play_batch)
