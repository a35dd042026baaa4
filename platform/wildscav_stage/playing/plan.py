"""Which match is played: its spec, who sits where, and their names."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from pydantic import ValidationError

from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean
from wildscav_engine.maps.catalogue import map_spec
from wildscav_engine.maps.errors import MapError
from wildscav_engine.record import RecordError, check_recordable
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import RULES
from wildscav_engine.specs.validation import one_line
from wildscav_engine.tracks import TRACKS
from wildscav_server.hosting.opponents import Opponent, numbered, submission_opponent
from wildscav_stage.playing.shooting_range import TARGETS, Target, range_spec

if TYPE_CHECKING:
    from wildscav_server.hosting.reports import MatchOutcome

PERSON = "person"
SPECTATOR_DELAY = 3.0  # s
FRAMES_PER_ACTION = 1  # so that a person's inputs take effect 50 times a second
DEFAULT_MAP = MapConfig(size=120, houses=5, water=0.05)
STAND_INS = {  # the robots that play for people who are not here
    "navigation": "seeker-easy",
    "gathering": "gatherer-easy",
    "capture": "seeker-easy",
    "battle": "fighter-easy",
    "royale": "fighter-easy",
}
DEFAULT_OPPONENTS = {"battle": ("fighter-easy", "gatherer", "fighter"), "royale": ("fighter-easy",) * 5}


@dataclass(frozen=True)
class RangeTarget(Opponent):
    """A target at the shooting range."""

    target: Target | None = None


class Given(Protocol):
    """One of several given matches, which one person plays once each and as they are, against robots."""

    title: str  # which of them it is
    names: tuple[str, ...]  # the display name of every seat
    seed: int  # the private seed of the person's seat
    record: Path  # where its record goes

    def begin(self) -> None:
        """Note that it begins, or begins again."""

    def end(self, outcome: "MatchOutcome") -> "Plan | None":
        """Keep how it ended, and return the plan of the next match; None if it was the last one."""


@dataclass(frozen=True)
class Plan:
    """A match that can be played several times, each time with another seed, unless it is a given one."""

    spec: MatchSpec
    opponents: tuple[Opponent, ...]
    people: int = 1  # who have the first seats; submissions have the next ones, and robots the last
    given: Given | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The display name of every seat, different ones for people and for opponents of the same kind."""
        if self.given is not None:
            return self.given.names
        return numbered([PERSON] * self.people + [opponent.name for opponent in self.opponents])

    @property
    def targets(self) -> dict[int, Target]:
        """The targets of a shooting range, by their seats; elsewhere, there are none."""
        opponents = enumerate(self.opponents, start=self.people)
        return {
            seat: opponent.target
            for seat, opponent in opponents
            if isinstance(opponent, RangeTarget) and opponent.target is not None
        }

    @property
    def may_pause(self) -> bool:
        """Whether nobody but one person needs time to think."""
        return self.people == 1 and all(opponent.folder is None for opponent in self.opponents)

    @property
    def delay(self) -> float:
        """After how many s spectators see a match: where people meet, none may tell one where others are."""
        return SPECTATOR_DELAY if self.people > 1 else 0.0

    @property
    def stand_in(self) -> str:
        """The robot that plays for people who are not here when a match starts."""
        return STAND_INS.get(self.spec.track, "walker")

    @property
    def submissions(self) -> tuple[int, ...]:
        """The seats of submissions."""
        opponents = enumerate(self.opponents, start=self.people)
        return tuple(seat for seat, opponent in opponents if opponent.folder is not None)

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots, which have the last seats."""
        return tuple(opponent.name for opponent in self.opponents if opponent.folder is None)

    def arranged(self, robots: Sequence[str], *, new_map: bool) -> "Plan":
        """Return the plan with other robots, and perhaps with the next map of its kind.

        Raises:
            UserError: There is no such robot, such a match is not possible or cannot be recorded, or this is
                a shooting range or a given match.
        """
        if self.targets:
            raise UserError("the shooting range has targets and a lawn of its own")
        if self.given is not None:
            raise UserError("a given match is played as it is")
        for name in robots:
            if name not in ROBOTS:
                raise UserError(f"there is no robot {name!r}{did_you_mean(name, ROBOTS)}")
        spec, others = self.spec, self.opponents[: len(self.submissions)]
        changed: dict[str, Any] = {"seats": (*spec.seats[: self.people + len(others)], *robots)}
        if new_map:
            changed["map"] = spec.map.model_copy(update={"seed": (spec.map.seed + 1) % 2**64})
        try:
            arranged = MatchSpec.model_validate(spec.model_dump() | changed)
            check_recordable(arranged)
        except ValidationError as error:
            raise UserError(f"such a match is not possible: {one_line(error)}") from None
        except RecordError as error:
            raise UserError(str(error)) from None
        return replace(self, spec=arranged, opponents=(*others, *map(Opponent, robots)))

    def played(self, times: int, absent: Collection[int] = ()) -> MatchSpec:
        """Return the spec of the match after it was played some times; robots play for the absent."""
        if self.given is not None:
            return self.spec
        seats = (self.stand_in if seat in absent else who for seat, who in enumerate(self.spec.seats))
        return self.spec.model_copy(update={"seed": (self.spec.seed + times) % 2**64, "seats": tuple(seats)})


def make_plan(
    track: str,
    map_id: int | None,
    seed: int,
    opponents: Sequence[str] | None,
    time_limit: float | None,
    people: int = 1,
    rules: str = "original",
) -> Plan:
    """Return the plan of a match in which people have the first seats.

    Args:
        track: The name of a track.
        map_id: Number of a map; None for a map that is generated from the seed.
        seed: Seed of the match.
        opponents: Names of robots and folders of submissions, whose seats come before those of robots; None
            for as many as suit the track, fewer with more people.
        time_limit: s of game time; None for the track's.
        people: How many people can play.
        rules: The name of rules.

    Raises:
        UserError: Such a match is not possible.
    """
    if track not in TRACKS:
        raise UserError(f"--track is {track!r}; the tracks are {', '.join(TRACKS)}", exit_code=2)
    usual = DEFAULT_OPPONENTS.get(track, ())
    wanted = usual[: max(0, len(usual) + 1 - people)] if opponents is None else opponents
    chosen = tuple(sorted((_opponent(text, track) for text in wanted), key=lambda one: one.folder is None))
    filled_by = (SUBMISSION if opponent.folder else opponent.name for opponent in chosen)
    try:
        spec = MatchSpec(
            track=track,
            map=MapSpec(config=DEFAULT_MAP, seed=seed) if map_id is None else map_spec(map_id),
            seed=seed,
            seats=(*(SUBMISSION,) * people, *filled_by),
            time_limit=TRACKS[track].time_limit if time_limit is None else time_limit,
            frames_per_action=FRAMES_PER_ACTION,
            rules=RULES.validate_python(rules),
        )
        check_recordable(spec)
    except ValidationError as error:
        raise UserError(f"such a match is not possible: {one_line(error)}", exit_code=2) from error
    except (MapError, RecordError) as error:
        raise UserError(str(error), exit_code=2) from None
    return Plan(spec, chosen, people)


def given_plan(spec: MatchSpec, given: Given) -> Plan:
    """Return the plan of a given match, in which the person has the first seat and robots have the others."""
    return Plan(spec, tuple(map(Opponent, spec.seats[1:])), given=given)


def make_range(seed: int, time_limit: float | None, rules: str = "original") -> Plan:
    """Return the plan of a person's practice at the shooting range; see ``make_plan``."""
    spec = range_spec(seed, time_limit, rules, FRAMES_PER_ACTION)
    return Plan(spec, tuple(RangeTarget(target.name, target=target) for target in TARGETS))


def _opponent(text: str, track: str) -> Opponent:
    if text in ROBOTS:
        return Opponent(text)
    folder = Path(text)
    if not folder.is_dir():
        raise UserError(
            f"--opponents has {text!r}, which is neither a robot ({', '.join(ROBOTS)}) nor a folder"
            f"{did_you_mean(text, ROBOTS)}",
            exit_code=2,
        )
    return submission_opponent(folder, track)
