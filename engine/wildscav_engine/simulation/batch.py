"""A batch: many matches played together in one or several threads. A single match is a batch of one."""

import copy
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.compilation.tables.array_tables import Addresses, ArrayTable
from wildscav_engine.compilation.tables.row_copy import clear_rows, fills_of
from wildscav_engine.maps import MapError, map_of
from wildscav_engine.maps.bank import MapBank
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.parallel.threads import share
from wildscav_engine.simulation.batch_kernels import (
    BatchArrays,
    find_seen_in_batch,
    play_batch,
    play_batch_with_robots,
)
from wildscav_engine.simulation.setup.match_setup import MatchSetupError, place_match, plan_match, room_for
from wildscav_engine.simulation.snapshot import Counts, History, check_size, decode, encode, map_for, write
from wildscav_engine.simulation.state import State, allocate_state, copied, with_room
from wildscav_engine.simulation.systems.visibility import Seen, allocate_seen
from wildscav_engine.simulation.track import TRACKS
from wildscav_engine.specs.actions import FIELDS, Field, no_actions
from wildscav_engine.specs.match_spec import MatchSpec

LEAST_AGENTS = 200  # per thread; a step of fewer agents takes no longer than waking the thread


class Batch:
    """Matches of one track under the same rules; their maps, seeds, targets and time limits may differ."""

    def __init__(
        self,
        specs: Sequence[MatchSpec],
        maps: Sequence[GameMap] | None = None,
        *,
        pool: Sequence[GameMap] = (),
    ) -> None:
        """Set up the matches.

        Args:
            specs: One for each match.
            maps: One for each match, if already available; otherwise they are generated.
            pool: Maps on which matches will be restarted later.
        """
        self.specs = list(specs)
        self.maps = _maps_for(self.specs, maps)
        first = _shared(self.specs)
        self.track = TRACKS[first.track]
        self.rules = first.rules
        self.frames_per_action = first.frames_per_action
        self.allowed = np.array([field in self.track.fields for field in Field])
        self.setups = [plan_match(*pair) for pair in zip(self.specs, self.maps, strict=True)]
        seats = max(len(spec.seats) for spec in self.specs)
        self._seen = allocate_seen(len(self.specs), seats)
        self._all_seats = range(seats)
        self._seen_now: set[int] = set()  # the seats whose rows of what is seen are up to date
        self._set_arrays(allocate_state(len(self.specs), seats, *room_for(self.setups)))
        self._rule_numbers = np.array(self.rules, np.float64)
        self._table: ArrayTable | None = None
        self._bank = MapBank([*self.maps, *pool])
        self._rows = np.arange(len(self.specs))
        self._no_actions = no_actions(len(self.specs) * seats).reshape(len(self.specs), seats, FIELDS)
        self.played: NDArray[np.float32] = self._no_actions  # (B, A, FIELDS) the actions of the last step
        self._open_matches(self._rows)

    @property
    def seen(self) -> Seen:
        """What every agent sees now; computed on demand, at most once per step."""
        return self.seen_by(self._all_seats)

    def seen_by(self, seats: Sequence[int], threads: int = 1) -> Seen:
        """Return what agents see now, for some seats only: the rows of others may be of an earlier step."""
        missing = [seat for seat in seats if seat not in self._seen_now]
        if missing:
            chosen = np.array(missing, np.int64)
            if threads == 1:
                self._find_seen(self._rows, chosen)
            else:
                self._share(lambda rows: self._find_seen(rows, chosen), threads)
            self._seen_now.update(missing)
        return self._seen

    def _find_seen(self, rows: NDArray[np.int64], seats: NDArray[np.int64]) -> bool:
        find_seen_in_batch(self.table, rows, seats)
        return True

    @property
    def tables(self) -> tuple[Addresses, Addresses, Addresses, Addresses]:
        """The array tables of the agents, the boxes, the matches and what is seen now, for kernels."""
        _ = self.seen
        return self.known_tables

    def step(self, actions: ArrayLike, *, threads: int = 1) -> NDArray[np.float32]:
        """Play one step of every match that is not over; return (B, A, FIELDS) the actions as played.

        Rows of robots are replaced by the robots' actions, fields outside the track's action set count as
        zero, and a row with a number that is not finite or a walk speed outside 0–10 m/s does nothing. Small
        batches use fewer threads; the outcome does not depend on them, bit for bit.

        Raises:
            ValueError: The actions have another shape or are not real numbers, or ``threads`` is less than 1.
        """
        rows = check_actions(actions, self.state.agents.present.shape)
        if threads < 1:
            raise ValueError(f"threads is {threads}, must be at least 1")
        self.play(rows, threads)
        return rows

    def play(self, actions: NDArray[np.float32], threads: int = 1) -> None:
        """Do the same as ``step`` without checks, and replace the actions by those that were played."""
        self._seen_now.clear()
        self.played = actions
        if threads == 1:
            self._play(self._rows, actions)
        else:
            self._share(lambda rows: self._play(rows, actions), threads)

    def _share(self, work: Callable[[NDArray[np.int64]], bool], threads: int) -> None:
        """Do some work for all rows of matches, in one or several threads."""
        least = -(-LEAST_AGENTS // len(self._all_seats))
        share(lambda part: work(self._rows[part]), len(self._rows), threads, least)

    def restart(
        self, rows: Sequence[int], specs: Sequence[MatchSpec], maps: Sequence[GameMap] | None = None
    ) -> None:
        """Start new matches in some rows, as in a new batch, without changing the other rows.

        If a match has more boxes, zone phases or hot spots than any before it, the batch allocates larger
        arrays for them. References to ``state`` are then outdated: read it from the batch again after this
        call. A match may have no more seats than the largest with which the batch was created.

        Raises:
            MatchSetupError: A match cannot be set up or cannot be in this batch; no row has changed.
            ValueError: A row does not exist or is listed twice.
        """
        _check_rows(rows, len(self.specs))
        if not rows:
            return
        given = _maps_for(specs, maps, len(rows))
        _shared([self.specs[0], *specs])
        _check_seats(specs, self.state.agents.present.shape[1])
        setups = [plan_match(*pair) for pair in zip(specs, given, strict=True)]
        for row, spec, game_map, setup in zip(rows, specs, given, setups, strict=True):
            self.specs[row], self.maps[row], self.setups[row] = spec, game_map, setup
        self._grow(*room_for(setups))
        self._clear(rows)
        if self._add_to_bank(given):
            self._number_maps(self._rows)  # also in the other rows: their maps may have moved in the bank
        self._open_matches(np.array(rows, np.int64))

    def get_state(self, row: int, history: History | None = None) -> bytes:
        """Return one match as bytes, with what was played so far if given; such a batch can continue it."""
        tables = self.known_tables
        return encode(self.specs[row], self.maps[row], tables, row, self._counts(row), history)

    def set_state(self, row: int, data: bytes) -> History | None:
        """Restore a match from ``get_state`` into a row, and return what was played so far if it is stored.

        The other rows do not change. As with ``restart``, the arrays of ``state`` may be replaced, and if it
        fails, no row has changed.

        Raises:
            StateError: The bytes are not a state, are damaged, or have another version of the rules or of
                the map.
            MatchSetupError: The match cannot be in this batch.
        """
        _check_rows([row], len(self.specs))
        snapshot = decode(data)
        spec, (_, *room) = snapshot.spec, snapshot.counts
        _shared([self.specs[0], spec])
        _check_seats([spec], self.state.agents.present.shape[1])
        game_map = map_for(snapshot, self.maps)
        setup = plan_match(spec, game_map)
        check_size(snapshot, self.known_tables)
        self._grow(*room)
        self._clear([row])
        self._seen_now.clear()
        write(snapshot, self.known_tables, row)
        self.specs[row], self.maps[row], self.setups[row] = spec, game_map, setup
        self._add_to_bank([game_map])
        self._number_maps(self._rows)
        return snapshot.history

    def fork(self) -> "Batch":
        """Return an independent batch in the same state; the maps are shared."""
        other = copy.copy(self)
        other._take_copies()  # noqa: SLF001 - a method of this class
        return other

    def _take_copies(self) -> None:
        """Replace everything mutable that is shared with the original by copies."""
        self.specs, self.maps, self.setups = list(self.specs), list(self.maps), list(self.setups)
        self._bank = self._bank.fork()
        self._seen, self._seen_now = copied(self._seen), set(self._seen_now)
        self._set_arrays(State(*map(copied, self.state)))

    def _counts(self, row: int) -> Counts:
        """Return the numbers of what a match has, as a snapshot counts them."""
        every = self.state.matches
        counted = (every.seats, every.slots, every.phases, every.places, every.waves)
        seats, slots, phases, places, waves = (int(counts[row]) for counts in counted)
        return seats, slots, phases, places, waves

    def _clear(self, rows: Sequence[int]) -> None:
        for table, fills in zip(self.known_tables, _FILLS, strict=True):
            clear_rows(table, fills, np.array(rows, np.int64))

    def _open_matches(self, rows: NDArray[np.int64]) -> None:
        """Write the initial state of matches into their rows, which have been cleared."""
        for row in rows.tolist():
            place_match(self.state, row, self.setups[row])
        self._number_maps(rows)
        self._seen_now.clear()
        self._play(rows, self._no_actions, is_reset=True)

    def _add_to_bank(self, maps: Sequence[GameMap]) -> bool:
        """Add maps to the bank, and return whether any was new."""
        has_changed = self._bank.add(maps, in_use=self.maps)
        if has_changed:
            self._table = None
        return has_changed

    def _number_maps(self, rows: NDArray[np.int64]) -> None:
        """Note where in the bank the maps of new matches are, and whether robots play in any match."""
        self._has_robots = bool(self.state.agents.robot.any())
        for row in rows.tolist():
            self.state.matches.map_index[row] = self._bank.index_of(self.maps[row])

    def _play(self, rows: NDArray[np.int64], actions: NDArray[np.float32], *, is_reset: bool = False) -> bool:
        """Open the matches in some rows, or play one step of them; return True, as ``share`` expects."""
        play = play_batch_with_robots if self._has_robots else play_batch
        play(self.table, rows, actions, self.frames_per_action, is_reset)
        return True

    def _grow(self, slots: int, phases: int, places: int, waves: int) -> None:
        state = with_room(self.state, slots, phases, places, waves)
        if state is not self.state:
            self._set_arrays(state)

    def _set_arrays(self, state: State) -> None:
        """Set the arrays of the state, and build the tables of all arrays."""
        self.state = state
        self._array_tables = *state.tables, ArrayTable(self._seen)
        self._table = None

    @property
    def table(self) -> Addresses:
        """The table of all arrays that kernels need of the batch, as ``batch_at`` reads it."""
        if self._table is None:
            arrays = BatchArrays(self._bank.addresses, *self.known_tables, self.allowed, self._rule_numbers)
            self._table = ArrayTable(arrays)
        return self._table.addresses

    def __getstate__(self) -> dict[str, Any]:
        """Copy and pickle everything but the addresses of arrays."""
        return {**vars(self), "_table": None}

    @property
    def known_tables(self) -> tuple[Addresses, Addresses, Addresses, Addresses]:
        """The same as ``tables`` without an update: what is seen is up to date as ``seen_by`` says."""
        agents, supplies, matches, seen = self._array_tables
        return agents.addresses, supplies.addresses, matches.addresses, seen.addresses


def _check_rows(rows: Sequence[int], matches: int) -> None:
    """Check that rows exist in a batch and are different."""
    if len(set(rows)) != len(rows) or not all(0 <= row < matches for row in rows):
        raise ValueError(f"rows are {list(rows)}, must be different and of 0 to {matches - 1}")


def _check_seats(specs: Sequence[MatchSpec], seats: int) -> None:
    """Check that matches do not have too many seats for their batch.

    Raises:
        MatchSetupError: A match does.
    """
    most = max(len(spec.seats) for spec in specs)
    if most > seats:
        raise MatchSetupError(f"a match has {most} seats, but those of this batch have at most {seats}")


def check_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Return a copy of actions as float32 rows with the axes (B, A) or (A,); else raise ValueError."""
    rows = np.asarray(actions)
    if rows.shape != (*shape, FIELDS) or rows.dtype.kind not in "biuf":
        wanted = (*shape, FIELDS)
        raise ValueError(
            f"actions are {rows.dtype} of shape {rows.shape}, must be real numbers of shape {wanted}"
        )
    if rows.dtype == np.float32:
        return rows.copy()
    with np.errstate(over="ignore"):  # a number too large for 32 bits becomes infinite, which does nothing
        return np.array(rows, np.float32, order="C")


def _maps_for(
    specs: Sequence[MatchSpec], maps: Sequence[GameMap] | None, matches: int | None = None
) -> list[GameMap]:
    """Return the map of every match, given or generated."""
    count = len(specs) if matches is None else matches
    if len(specs) != count:
        raise MatchSetupError(f"{len(specs)} specs are given for {count} matches")
    if maps is not None:
        if len(maps) != count:
            raise MatchSetupError(f"{len(maps)} maps are given for {count} matches")
        return list(maps)
    try:
        return [map_of(spec.map) for spec in specs]
    except MapError as error:
        raise MatchSetupError(str(error)) from error


def _shared(specs: Sequence[MatchSpec]) -> MatchSpec:
    """Check that specs can share a batch, and return the first one."""
    if not specs:
        raise MatchSetupError("a batch needs at least one match")
    first = specs[0]
    for field in ("track", "rules", "frames_per_action"):
        wanted = getattr(first, field)
        for spec in specs:
            value = getattr(spec, field)
            if value is not wanted and value != wanted:
                raise MatchSetupError(
                    f"the matches of a batch must have the same {field}, not {wanted} and {value}"
                )
    return first


_EXAMPLE = allocate_state(1, 1, 1, 1, 1, 1)
_FILLS = [fills_of(part) for part in (*_EXAMPLE, allocate_seen(1, 1))]
