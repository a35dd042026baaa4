"""What may be seen of a match, and by whom, before the season's secret is opened.

Every submission plays the same matches of a suite, and later ones play them again. So what shows their maps
(records, trails, replays, and what agents print) is hidden until the season is opened, from their own teams
too: an agent could print what it sees. A match of a ladder is played by its entrants alone, twice, and may be
seen when both are over.

Once the public boards are frozen, what is played shows nothing before the season is finalized.
"""

from collections.abc import Collection, Sequence
from datetime import datetime
from typing import NamedTuple

from sqlalchemy import and_, or_, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.matches.models import FINISHED, LADDER, PLAYING, VOID, Match, MatchResult
from wildscav_leaderboard.seasons.state import OPENED, frozen_since, read_state

REPEATS = 2  # matches of a game on a ladder


class Twin(NamedTuple):
    """The other match of a game on a ladder."""

    id: int
    state: str


def hidden_why(session: Session, match: Match) -> str:
    """Return why a match's record, trails and logs are hidden; an empty text if they are not."""
    return hidden_whys(session, [match])[match.id]


def hidden_whys(
    session: Session, matches: Sequence[Match], late: Collection[int] | None = None
) -> dict[int, str]:
    """Return why the records, trails and logs of some matches are hidden, by match.

    Args:
        session: A session.
        matches: The matches.
        late: Those whose results arrived after the freeze, if they are known.
    """
    late = _after_freeze(session, matches) if late is None else late
    opened = read_state(session, OPENED) is not None
    twins = {} if opened else twins_of(session, [match for match in matches if match.state == FINISHED])

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
        twin = twins.get(match.id)
        if twin is None or twin.state in (FINISHED, VOID):
            return ""
        return f"the same game is still to be played again, in other seats, as match {twin.id}"

    return {match.id: why(match) for match in matches}


def _after_freeze(session: Session, matches: Sequence[Match]) -> set[int]:
    """Return the matches whose results are hidden, since they arrived after the public boards were frozen."""
    since: datetime | None = frozen_since(session)
    if since is None:
        return set()
    numbers = [match.id for match in matches]
    results = select(MatchResult.match_id).where(MatchResult.match_id.in_(numbers), MatchResult.at > since)
    return {*session.scalars(results)}


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


def twin_of(session: Session, match: Match) -> Twin | None:
    """Return the match of a ladder in which the same game is played in other seats, if it is on one."""
    return twins_of(session, [match]).get(match.id)


def twins_of(session: Session, matches: Sequence[Match]) -> dict[int, Twin]:
    """Return the matches of ladders in which the same games are played in other seats, by match."""
    asked = {
        (match.track, match.group_id, match.number ^ 1): match.id for match in matches if match.kind == LADDER
    }
    if not asked:
        return {}
    of_ladders = [
        and_(
            Match.track == track,
            Match.group_id == group,
            Match.number.in_([number for *one, number in asked if one == [track, group]]),
        )
        for track, group in dict.fromkeys((track, group) for track, group, _ in asked)
    ]
    wanted = select(Match.track, Match.group_id, Match.number, Match.id, Match.state)
    found = session.execute(wanted.where(Match.kind == LADDER, or_(*of_ladders)))
    return {asked[track, group, number]: Twin(twin, state) for track, group, number, twin, state in found}
