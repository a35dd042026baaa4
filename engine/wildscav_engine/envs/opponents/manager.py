"""The opponents: who plays in each seat behind the learners', match by match, and what they do in a step."""

from collections.abc import Iterator, Sequence
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import philox
from wildscav_engine.envs.opponents.actors import Actor, ControllerActor, PolicyActor
from wildscav_engine.envs.opponents.observed import ObservedSeats, Seated, Settings, View, settings_of
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.settings.players import (
    Player,
    PolicyOpponent,
    Sampler,
    SeatController,
    name_of,
    read_player,
    seat_entry,
)
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.simulation.snapshot import StateError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.tracks import TRACKS

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch

WIN, DRAW, LOSS = 1.0, 0.5, 0.0
# A random stream in addition to those of ``Stream``, beside that of ``episodes.py``.
OPPONENTS = 65
ROBOT = -1  # instead of the number of an actor: the simulation plays the seat


def results_against(match: MatchInBatch, learners: int, seat: int) -> Iterator[float]:
    """Yield the results of an episode against one seat: one for each team of learners but the seat's own.

    The score decides, which is the first metric of the track; in ``royale``, the points, and so mainly the
    placement. The first learner of each team counts; learners have the first seats.
    """
    teams = match.spec.team_of_seats
    first_of_team = {teams[learner]: learner for learner in reversed(range(learners))}
    for team in sorted(first_of_team.keys() - {teams[seat]}):
        yield _compare(_score(match, first_of_team[team]), _score(match, seat))


def _score(match: MatchInBatch, seat: int) -> float:
    """Return the score of a seat; more is better."""
    track = TRACKS[match.spec.track]
    metric = track.metrics[0]
    score = track.measure(match, seat)[metric.name]
    return -score if metric.lower_is_better else score


def _compare(own: float, other: float) -> float:
    if own == other:
        return DRAW
    return WIN if own > other else LOSS


class OpponentManager:
    """Who fills the P seats behind the learners' in each of B matches.

    Each policy is called once per step for all seats that it fills. Which seats these are is computed only
    when that changes, so a step takes the same number of Python calls for any number of matches.

    Attributes:
        acts: Whether anybody but robots may fill a seat.
        reports: Whether results are recorded, because a sampler chooses who plays.
    """

    def __init__(self, config: EnvConfig, matches: int) -> None:
        """Create the players of an environment."""
        self._config, self._matches, self._entries = config, matches, config.players
        self._first = config.agents
        self.acts = any(not isinstance(entry, str) for entry in self._entries)
        self.reports = any(isinstance(entry, Sampler) for entry in self._entries)
        self._players: list[Sequence[Player]] = [()] * matches  # of each match
        self._next: dict[int, Sequence[Player]] = {}  # of matches that have not begun yet
        self._unrecorded: set[int] = set()  # matches among these whose result does not count
        self._counts = np.zeros(matches, np.bool_)  # (B,) matches whose result is still to be recorded
        self._numbers = np.full((matches, len(self._entries)), ROBOT, np.int64)  # (B, P) of actors
        self._actors: dict[int, Actor] = {}  # by number
        self._number_of: dict[Any, int] = {}  # of actors
        self._settings: dict[str, Settings] = {}  # of policies, by ``PolicyOpponent.settings_key``
        self._groups: list[tuple[Actor, Seated]] | None = None  # who fills which seats; None: outdated
        self._observed: dict[str, ObservedSeats] = {}  # by the key of settings
        for entry in self._entries:
            if isinstance(entry, PolicyOpponent):
                self._settings[entry.settings_key] = settings_of(config, entry)
            elif isinstance(entry, SeatController):
                entry.check(config.track)

    # Who plays.

    def choose(self, rows: Sequence[int], specs: Sequence[MatchSpec]) -> list[MatchSpec]:
        """Choose who plays the next matches in some rows; return their specs with what fills each seat."""
        if not self.acts:
            return list(specs)
        chosen = []
        for row, spec in zip(rows, specs, strict=True):
            players = self._drawn(spec.seed) if self.reports else self._entries
            self._next[row] = players  # type: ignore[assignment]
            seats = spec.seats[: self._first] + tuple(map(seat_entry, players))
            chosen.append(spec if seats == spec.seats else spec.model_copy(update={"seats": seats}))
        return chosen

    def _drawn(self, seed: int) -> list[Player]:
        """Return who plays a match with a seed."""
        word, _ = philox(np.uint64(seed), OPPONENTS, 0, 0, 0)
        random = Random(int(word))  # noqa: S311 (a game, not a secret)
        players: list[Any] = list(self._entries)
        samplers = {id(entry): entry for entry in self._entries if isinstance(entry, Sampler)}
        for sampler in samplers.values():
            places = [place for place, entry in enumerate(self._entries) if entry is sampler]
            drawn = sampler.sample(len(places), random)
            if len(drawn) != len(places):
                raise ValueError(
                    f"{type(sampler).__name__}.sample returned {len(drawn)} players for {len(places)} seats"
                )
            for place, player in zip(places, drawn, strict=True):
                players[place] = read_player(player)
        return players

    def begin(self, batch: "Batch", rows: Sequence[int]) -> None:
        """Begin the matches in some rows of a batch, which have been set up."""
        if not self.acts:
            return
        for row in rows:
            players = self._next.pop(row, self._players[row])
            self._counts[row] = row not in self._unrecorded
            self._unrecorded.discard(row)
            if players is not self._players[row]:
                self._players[row] = players
                self._numbers[row] = [self._number(player) for player in players]
                self._groups = None
        for observed in self._observed.values():
            observed.begin(batch, rows)
        self._begin_memories(batch, np.array(rows, np.int64))

    def _number(self, player: Player) -> int:
        """Return the number of the actor of a player; one policy with the same settings has one actor."""
        if isinstance(player, str):
            return ROBOT
        key: Any = id(player)
        if isinstance(player, PolicyOpponent):
            key = (id(player.policy), player.name, player.settings_key)
        if key not in self._number_of:
            number = self._number_of[key] = max(self._actors, default=ROBOT) + 1
            self._actors[number] = self._actor(player)
        return self._number_of[key]

    def _actor(self, player: PolicyOpponent | SeatController) -> Actor:
        if isinstance(player, SeatController):
            return ControllerActor(player)
        key = player.settings_key
        if key not in self._settings:
            self._settings[key] = settings_of(self._config, player)
        return PolicyActor(player, self._settings[key], self._first, len(self._entries))

    def _begin_memories(self, batch: "Batch", rows: NDArray[np.int64]) -> None:
        """Tell the players with a memory which of their seats begin new episodes."""
        for number, actor in self._actors.items():
            if actor.has_memory:
                found, places = np.nonzero(self._numbers[rows] == number)
                if len(found):
                    actor.begin(batch, Seated(rows[found], places + self._first))

    # What they do.

    def act(self, batch: "Batch", view: View, actions: NDArray[np.float32], skip: Sequence[int] = ()) -> None:
        """Write (B, A, FIELDS) the actions of all players but robots for a step, except in ``skip``.

        Seats of dead or eliminated agents are asked, too; their actions have no effect.
        """
        groups = self._groups if self._groups is not None else self._group(batch)
        for observed in self._observed.values():
            observed.forget()
        for actor, seated in groups:
            asked = seated.in_some(~np.isin(seated.matches, skip)) if len(skip) else seated
            if not len(asked.matches):
                continue
            if isinstance(actor, PolicyActor):
                observation = self._observed[actor.settings.key].of(batch, view, asked)
                actions[asked.matches, asked.seats] = actor.act(batch, asked, observation)
            else:
                actions[asked.matches, asked.seats] = actor.act(batch, asked)

    def _group(self, batch: "Batch") -> list[tuple[Actor, Seated]]:
        """Return which seats each actor fills, forget unused actors, and prepare the observations."""
        groups: list[tuple[Actor, Seated]] = []
        seats_of: dict[str, set[int]] = {}
        used = set(np.unique(self._numbers).tolist())
        self._actors = {number: actor for number, actor in self._actors.items() if number in used}
        self._number_of = {key: number for key, number in self._number_of.items() if number in used}
        for number, actor in self._actors.items():
            matches, places = np.nonzero(self._numbers == number)
            seated = Seated(matches, places + self._first)
            groups.append((actor, seated))
            if isinstance(actor, PolicyActor):
                seats_of.setdefault(actor.settings.key, set()).update(np.unique(seated.seats).tolist())
        self._observe(batch, {key: tuple(sorted(seats)) for key, seats in seats_of.items()})
        self._groups = groups
        return groups

    def _observe(self, batch: "Batch", seats_of: dict[str, tuple[int, ...]]) -> None:
        """Prepare to read the observations of certain seats, given by the key of settings."""
        configs = {
            actor.settings.key: actor.settings.config
            for actor in self._actors.values()
            if isinstance(actor, PolicyActor)
        }
        kept = self._observed
        self._observed = {}
        for key, seats in seats_of.items():
            if key in kept and kept[key].seats == seats:
                self._observed[key] = kept[key]
                continue
            self._observed[key] = ObservedSeats(configs[key], seats, self._matches)
            self._observed[key].begin(batch, range(self._matches))

    # Results.

    def report(self, done: NDArray[np.bool_], view: View) -> None:
        """Record the results of episodes that have ended since the last call, as (B, L) ``done`` says."""
        ended = done.all(axis=1) & self._counts
        if not ended.any():
            return
        self._counts[ended] = False
        for row in np.flatnonzero(ended).tolist():
            match = view(row)
            for place, (entry, player) in enumerate(zip(self._entries, self._players[row], strict=True)):
                if isinstance(entry, Sampler):
                    for result in results_against(match, self._first, self._first + place):
                        entry.record(name_of(player), result)

    # States.

    def names(self, match: int) -> list[str] | None:
        """Return the names of the players of a match, to be kept with its state; None if all are robots."""
        if not self.acts:
            return None
        for number in np.unique(self._numbers[match]).tolist():
            if number != ROBOT and self._actors[number].has_memory:
                raise StateError(
                    f"the opponent {self._actors[number].name!r} has a memory of its own, which is not part "
                    "of a state; states work with robots and with policies without reset() and act()"
                )
        return [name_of(player) for player in self._players[match]]

    def find(self, names: Sequence[str] | None) -> list[Player] | None:
        """Return the players whose names are kept with a state."""
        if (names is not None) != self.acts or (names is not None and len(names) != len(self._entries)):
            others = "robots only" if names is None else ", ".join(names)
            here = ", ".join(
                type(entry).__name__ if isinstance(entry, Sampler) else name_of(entry)
                for entry in self._entries
            )
            raise StateError(f"the state is of a match with other players ({others}) than here ({here})")
        if names is None:
            return None
        return [self._found(entry, name) for entry, name in zip(self._entries, names, strict=True)]

    def _found(self, entry: Player | Sampler, name: str) -> Player:
        if isinstance(entry, Sampler):
            try:
                return entry.member(name)
            except LookupError as error:
                raise StateError(f"the state is of a match with {name!r}: {error.args[0]}") from None
        if name_of(entry) != name:
            raise StateError(f"the state is of a match with {name!r} where {name_of(entry)!r} plays here")
        return entry

    def take(self, match: int, players: Sequence[Player] | None) -> None:
        """Let the players that ``find`` returned play a restored match, whose result is not recorded."""
        if players is not None:
            self._next[match] = players
            self._unrecorded.add(match)

    def count_all(self) -> None:
        """Record the results of restored matches, too: they continue a run, and are no forks of others."""
        self._counts[:] = True
