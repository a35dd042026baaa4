"""What may be seen of a match, and by whom, before the season's secret is opened.

Every submission plays the same matches of a suite, and later ones play them again. So what shows their maps
(records, trails, replays, and what agents print) is hidden until the season is opened, from their own teams
too: an agent could print what it sees. A match of a ladder is played by its entrants alone, twice, and may be
seen when both are over.

Once the public boards are frozen, what is played shows nothing before the season is finalized.
"""

from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.matches.models import FINISHED, LADDER, PLAYING, VOID, Match, MatchResult
from wildscav_leaderboard.seasons.state import OPENED, frozen_since, read_state

REPEATS = 2  # matches of a game on a ladder


def hidden_why(session: Session, match: Match) -> str:
    """Return why a match's record, trails and logs are hidden; an empty text if they are not."""
    return hidden_whys(session, [match])[match.id]


def hidden_whys(session: Session, matches: Sequence[Match]) -> dict[int, str]:
    """Return why the records, trails and logs of some matches are hidden, by match."""
    late = after_freeze(session, matches)
    opened = read_state(session, OPENED) is not None
    waiting = {} if opened else _twins_to_be_played(session, matches)

    def why(match: Match) -> str:
        if match.state != FINISHED:
            return "the match is not over"
        if match.id in late:
            return "the public boards are frozen, so it is hidden until the season is finalized"
        if opened:
            return ""
        if match.kind != LADDER:
            return (
                "everyone plays this match of the suite, so it is hidden until the season's secret is opened "
                "at its end"
            )
        twin = waiting.get((match.track, match.number ^ 1))
        return (
            ""
            if twin is None
            else f"the same game is still to be played again, in other seats, as match {twin}"
        )

    return {match.id: why(match) for match in matches}


def after_freeze(session: Session, matches: Sequence[Match]) -> set[int]:
    """Return the matches whose results are hidden, since they arrived after the public boards were frozen."""
    since: datetime | None = frozen_since(session)
    if since is None:
        return set()
    results = select(MatchResult.match_id).where(
        MatchResult.match_id.in_([match.id for match in matches]), MatchResult.at > since
    )
    return {*session.scalars(results)}


def _twins_to_be_played(session: Session, matches: Sequence[Match]) -> dict[tuple[str, int], int]:
    """Return those other matches of the same games that are not over, by track and number."""
    found: dict[tuple[str, int], int] = {}
    for track in {match.track for match in matches if match.kind == LADDER}:
        numbers = [match.number ^ 1 for match in matches if match.kind == LADDER and match.track == track]
        wanted = select(Match.number, Match.id).where(
            Match.kind == LADDER,
            Match.track == track,
            Match.number.in_(numbers),
            Match.state.not_in((FINISHED, VOID)),
        )
        found |= {(track, number): twin for number, twin in session.execute(wanted)}
    return found


def live_hidden_why(session: Session, match: Match) -> str:
    """Return why a match cannot be watched while it is played; an empty text if it can."""
    if match.state != PLAYING:
        return "the match is not being played"
    if frozen_since(session) is not None:
        return "the public boards are frozen, so it is hidden until the season is finalized"
    twin = twin_of(session, match)
    if twin is None or twin.state not in (FINISHED, VOID):
        return "others play the same game later, so it cannot be watched before that"
    return ""


def twin_of(session: Session, match: Match) -> Match | None:
    """Return the match of a ladder in which the same game is played in other seats, if it is on one."""
    if match.kind != LADDER:
        return None
    wanted = select(Match).filter_by(kind=LADDER, track=match.track, number=match.number ^ 1)
    return session.scalars(wanted).one_or_none()
