"""The matches of a suite that is played in several rounds, each with the next seed."""

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.bounds import MOST_MATCHES
from wildscav_evaluator.suites.suite import Suite


def matches_in_rounds(suite: Suite, track: str, seed: int, rounds: int) -> tuple[MatchSpec, ...]:
    """Return the matches of a suite on a track, played in rounds of consecutive seeds.

    Raises:
        UserError: There are too many.
    """
    match_count(suite, track, rounds)
    return tuple(spec for turn in range(rounds) for spec in suite.matches(track, seed + turn))


def match_count(suite: Suite, track: str, rounds: int) -> int:
    """Return how many matches a suite has on a track.

    Raises:
        UserError: There are too many.
    """
    settings = suite.tracks[track]
    count = settings.maps * settings.episodes * rounds
    if count > MOST_MATCHES:
        raise UserError(
            f"suite {suite.name} has {count:,} matches of {track} in {rounds:,} rounds; at most "
            f"{MOST_MATCHES:,} are allowed",
            exit_code=2,
        )
    return count
