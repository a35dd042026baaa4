"""Drawing the matches of a tournament: those of a suite, with the schedule's entrants in the seats."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from hashlib import blake2b
from typing import NamedTuple

from pydantic import ValidationError

from wildscav.errors import UserError
from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.validation import one_line
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.output.results import TournamentSettings
from wildscav_evaluator.seats import ROBOT_ENTRANT, display_names, shuffled
from wildscav_evaluator.suites.suite import Suite
from wildscav_evaluator.tournaments.names import groups_of
from wildscav_evaluator.tournaments.pairings import round_games
from wildscav_evaluator.tournaments.schedule import Schedule, check_schedule, entrants_of_game, make_schedule


class TournamentMatch(NamedTuple):
    """One match of a tournament."""

    game: int  # the number of its map and match seed; a game is played several times
    spec: MatchSpec
    entrants: dict[int, str]  # the name of the entrant in each seat that has one, in the order of the seats

    @property
    def robots(self) -> tuple[int, ...]:
        """The seats of robots that are entrants."""
        return tuple(seat for seat in self.entrants if self.spec.seats[seat] != SUBMISSION)

    @property
    def submissions(self) -> list[str]:
        """The names of the submissions, in the order of their seats."""
        return [name for seat, name in self.entrants.items() if self.spec.seats[seat] == SUBMISSION]

    @property
    def names(self) -> tuple[str, ...]:
        """The display name of every seat."""
        return display_names(self.spec.seats, self.submissions, self.robots)


def tournament_matches(
    suite: Suite, track: str, seed: int, rounds: int, settings: TournamentSettings, entrants: Sequence[str]
) -> tuple[TournamentMatch, ...]:
    """Return the matches of a tournament, in the order of its schedule.

    The names of the entrants are sorted; those of robots begin with ``robot:``. UserError if there is no such
    schedule, or the suite's matches cannot be played by so many seats.
    """
    digest = blake2b(f"tournament/{suite.name}/{track}/{seed}".encode(), digest_size=8).digest()
    drawn = int.from_bytes(digest, "little")
    schedule = _schedule(drawn, rounds, settings, entrants)
    games = suite_games(suite, track, seed, int(schedule.games.max()) + 1)
    try:
        return tuple(_matches(games, schedule, settings, entrants))
    except ValidationError as error:
        raise UserError(
            f"suite {suite.label} has no matches of {track} with {settings.seats} seats for entrants "
            f"and {len(settings.robots)} robots: {one_line(error)}",
            exit_code=2,
        ) from error


def tournament_match_count(rounds: int, settings: TournamentSettings, entrants: Sequence[str]) -> int:
    """Return how many matches a tournament has, whatever its seed; UserError if there is no such schedule."""
    groups = None if settings.meet_own else groups_of(entrants)
    with _refusing(settings, entrants):
        places = entrants_of_game(settings.seats, settings.team_size, settings.mixed)
        check_schedule(len(entrants), places, settings.seats, rounds, settings.repeats, groups)
    return round_games(len(entrants), places) * rounds * settings.repeats


def _schedule(seed: int, rounds: int, settings: TournamentSettings, entrants: Sequence[str]) -> Schedule:
    with _refusing(settings, entrants):
        return make_schedule(
            len(entrants),
            seats=settings.seats,
            rounds=rounds,
            seed=seed,
            team_size=settings.team_size,
            mixed=settings.mixed,
            repeats=settings.repeats,
            groups=None if settings.meet_own else groups_of(entrants),
        )


@contextmanager
def _refusing(settings: TournamentSettings, entrants: Sequence[str]) -> Iterator[None]:
    """Pass on, for the user, why there is no such schedule."""
    try:
        yield
    except ValueError as error:
        raise UserError(
            f"such a tournament is not possible: {error}{_advice(settings, entrants)}", exit_code=2
        ) from error


def _advice(settings: TournamentSettings, entrants: Sequence[str]) -> str:
    """Return what to do if entries of one submission are too many to be kept apart; else an empty text."""
    largest = max(Counter(groups_of(entrants)).values())
    if settings.meet_own or largest <= max(1, len(entrants) // settings.places):
        return ""
    return "; --meet-own lets entries of one submission meet"


def suite_games(suite: Suite, track: str, seed: int, count: int) -> list[MatchSpec]:
    """Return the first matches of a suite, played in rounds of consecutive seeds."""
    settings = suite.tracks[track]
    passes = math.ceil(count / (settings.maps * settings.episodes))
    return [spec for turn in range(passes) for spec in suite.matches(track, seed + turn)][:count]


def _matches(
    games: Sequence[MatchSpec], schedule: Schedule, settings: TournamentSettings, entrants: Sequence[str]
) -> list[TournamentMatch]:
    robots = [name.removeprefix(ROBOT_ENTRANT) if name.startswith(ROBOT_ENTRANT) else "" for name in entrants]
    specs: dict[tuple[int, tuple[str, ...]], MatchSpec] = {}
    matches = []
    for game, players in zip(schedule.games.tolist(), schedule.players.tolist(), strict=True):
        places = _places(games[game], settings)
        waiting = iter(players)
        seated = {seat: next(waiting) for seat, place in enumerate(places) if place == SUBMISSION}
        seats = tuple(
            (robots[seated[seat]] or SUBMISSION) if seat in seated else place
            for seat, place in enumerate(places)
        )
        if (game, seats) not in specs:
            specs[game, seats] = with_seats(games[game], seats, tuple(seated), settings)
        named = {seat: entrants[player] for seat, player in seated.items()}
        matches.append(TournamentMatch(game, specs[game, seats], named))
    return matches


def _places(game: MatchSpec, settings: TournamentSettings) -> tuple[str, ...]:
    """Return what each seat is for, whenever a game is played: an entrant, or a robot that is not rated."""
    return shuffled(RandomStream(game.seed, Stream.SUITE), (SUBMISSION,) * settings.seats + settings.robots)


def is_of_game(spec: MatchSpec, game: MatchSpec, rated: Sequence[int], settings: TournamentSettings) -> bool:
    """Return whether a match is of a suite's game, whichever entrants sit in the ``rated`` seats."""
    places = _places(game, settings)
    free = tuple(seat for seat, place in enumerate(places) if place == SUBMISSION)
    if len(spec.seats) != len(places) or tuple(rated) != free:
        return False
    seats = tuple(spec.seats[seat] if seat in free else place for seat, place in enumerate(places))
    try:
        return spec == with_seats(game, seats, rated, settings)
    except ValidationError:
        return False


def with_seats(
    spec: MatchSpec, seats: tuple[str, ...], rated: Sequence[int], settings: TournamentSettings
) -> MatchSpec:
    """Return a match with other seats and their teams.

    Of the ``rated`` seats, those of entrants, the first ``team_size`` form a team, and so on.
    """
    team = {seat: place // settings.team_size for place, seat in enumerate(rated)}
    others = [seat for seat in range(len(seats)) if seat not in team]
    first, together = settings.seats // settings.team_size, has_teams(spec.track)
    team |= {seat: first + (0 if together else place) for place, seat in enumerate(others)}
    teams = tuple(team[seat] for seat in range(len(seats)))
    default = TRACKS[spec.track].teams(len(seats))
    return MatchSpec.model_validate(
        {**dict(spec), "seats": seats, "teams": None if teams == default else teams}
    )


def has_teams(track: str) -> bool:
    """Return whether the seats of a track form one team unless a match says otherwise."""
    return len(set(TRACKS[track].teams(2))) == 1
