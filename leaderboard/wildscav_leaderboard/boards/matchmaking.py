"""Who meets whom on a ladder.

Whoever has the fewest matches is next, so that new submissions are rated quickly and nobody waits forever.
It plays until its rating is settled. It meets anyone whose rating is near its own, chosen by chance: a match
against one who is far away tells little. Opponents are not chosen more closely, because whoever was lucky
would then meet others who were, and the ratings of equals would drift apart. Robots, which anchor the scale,
are opponents like others, but no match is made for their sake. Submissions of one team never meet.

Every game, a map and a match seed, is played twice by the same entrants, the second time in other seats, so
that nobody is lucky with the start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_evaluator.output.results import TournamentSettings
from wildscav_evaluator.seats import ROBOT_ENTRANT, shuffled
from wildscav_evaluator.suites.suite import Suite
from wildscav_evaluator.tournaments.drawing import with_seats

REPEATS = 2  # matches of a game
NEAR = 400.0  # points of rating: odds of 10 : 1


@dataclass(frozen=True)
class Candidate:
    """An entrant that may be seated."""

    name: str  # the submission's entrant, or robot:NAME
    team: int | None  # None for a robot
    rating: float  # on the scale of Elo
    matches: int  # that it has played or is planned to play
    is_settled: bool = False  # whether its rating is known well enough

    @property
    def is_robot(self) -> bool:
        """Whether it is a robot, which is never in need of matches."""
        return self.team is None


def choose_entrants(
    candidates: Sequence[Candidate], seats: int, most: int, key: str
) -> tuple[Candidate, ...] | None:
    """Return who meets in the next game; None if nobody needs one, or too few could meet.

    Args:
        candidates: All active submissions and the robots of the track.
        most: Matches after which no more are made for a submission, even if its rating is not settled.
        key: Decides between equals; another one for every game.
    """
    needy = sorted(
        (one for one in candidates if not (one.is_robot or one.is_settled) and one.matches < most),
        key=lambda one: (one.matches, _hash(key, one.name)),
    )
    for first in needy:
        met = _opponents(first, candidates, seats - 1, key)
        if met is not None:
            return (first, *met)
    return None


def _opponents(
    first: Candidate, candidates: Sequence[Candidate], count: int, key: str
) -> list[Candidate] | None:
    """Return opponents of one candidate, of different teams; None if there are too few."""
    near = sorted(
        (one for one in candidates if one is not first),
        key=lambda one: (max(0.0, abs(one.rating - first.rating) - NEAR), _hash(key, one.name)),
    )
    teams, chosen = {first.team}, list[Candidate]()
    for one in near:
        if len(chosen) < count and (one.is_robot or one.team not in teams):
            chosen.append(one)
            teams.add(one.team)
    return chosen if len(chosen) == count else None


def _hash(key: str, name: str) -> bytes:
    return blake2b(f"{key}/{name}".encode(), digest_size=8).digest()


def ladder_match(
    suite: Suite, track: str, seed: int, number: int, entrants: Sequence[str]
) -> tuple[MatchSpec, dict[int, str]]:
    """Return a match of a ladder, and who plays in each seat. It depends on nothing but the arguments.

    Args:
        suite: From which everything but the seats is drawn.
        number: Of the match on its ladder.
        entrants: Who meets, sorted by name.
    """
    game, turn = divmod(number, REPEATS)
    return seated(ladder_game(suite, track, seed, game), turn, entrants)


def ladder_game(suite: Suite, track: str, seed: int, game: int) -> MatchSpec:
    """Return a game of a ladder: a match of the suite, whose seats are to be filled.

    Args:
        game: Its number, from 0; when the suite is used up, it is drawn again with the next seed.
    """
    settings = suite.tracks[track]
    passes, index = divmod(game, settings.maps * settings.episodes)
    return suite.matches(track, seed + passes)[index]


def seated(spec: MatchSpec, turn: int, entrants: Sequence[str]) -> tuple[MatchSpec, dict[int, str]]:
    """Return a match of a game, and who plays in each seat.

    Args:
        turn: Which of its matches, from 0.
        entrants: Who meets, sorted by name.
    """
    order = shuffled(RandomStream(spec.seed, Stream.SUITE), entrants)
    half = len(order) * turn // REPEATS
    taken = (*order[half:], *order[:half])
    seats = tuple(
        name.removeprefix(ROBOT_ENTRANT) if name.startswith(ROBOT_ENTRANT) else SUBMISSION for name in taken
    )
    rules = TournamentSettings(seats=len(seats))
    return with_seats(spec, seats, tuple(range(len(seats))), rules), dict(enumerate(taken))
