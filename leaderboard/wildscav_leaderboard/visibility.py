"""Who may see what: whoever gives out anything that is not for everyone asks here.

Organizers see everything. Of a match, ``seen_by`` decides. Who plays whom is for everyone. For the rest:

Every submission plays the same matches of a suite, and later ones play them again. An agent could print what
it sees there, or say it by its outcomes and delays. So all of it is hidden until the season is opened, from
its own team too. A match of a ladder is played by its entrants alone, twice: everyone may see its outcome at
once, and its record when both are over. What an agent can write or time there is for its own team alone.

Once the public boards are frozen, what is played shows nothing to other teams before the season is finalized,
and neither does the history of boards (``shown_until``). Of a submission, ``is_own`` decides who may see what
is for its team, and ``listed_for`` whether it is in lists.
"""

from collections.abc import Collection, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from sqlalchemy import ColumnElement, and_, func, or_, select, true
from sqlalchemy.orm import Session, defer

from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, LADDER, PLAYING, VOID, Match, MatchResult, MatchSeat
from wildscav_leaderboard.matches.service import find_match, list_matches
from wildscav_leaderboard.seasons import state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError, UnknownCallerError
from wildscav_leaderboard.seasons.state import OPENED, is_finalized, read_state
from wildscav_leaderboard.spectating.kept_notes import SeenLog
from wildscav_leaderboard.spectating.live import NOT_PLAYED
from wildscav_leaderboard.spectating.render_cache import QUIET
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.states import CANCELLED, FAILED
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import team_of

OF_SUITE = (
    "every submission plays this match of the suite, so it is hidden until the season's secret is opened "
    "at its end, even from its own team"
)
NEWEST = 20  # finished matches of which something is shown, and made, before anybody asks
FROZEN = "the public boards are frozen, so it is hidden until the season is finalized"

# Audiences of boards: everyone; organizers, once the public board is frozen; everyone who wants to see how
# a board was before the season was decided.
PUBLIC, HIDDEN, SEASON = "public", "hidden", "season"
EDITION = "edition-"


class Twin(NamedTuple):
    """The other match of a game on a ladder."""

    id: int
    state: str


class Visible(NamedTuple):
    """What somebody may see of a match: each part is why it is hidden, or an empty text."""

    record: str  # its record, with trails, map, replay and video, and the logs of the caller's own team
    live: str  # its trails and map while it is played
    outcome: str  # how it ended in every seat: status, fault and figures
    own: str  # that in seats of the caller's own team; what its agents wrote there; when and how long it took
    team: str | None  # the caller's
    everything: bool  # whether all seats are as the caller's own: for organizers

    def is_own(self, team: str | None) -> bool:
        """Return whether a seat of a team is as the caller's own."""
        return self.everything or (team is not None and team == self.team)

    def outcome_in(self, team: str | None) -> str:
        """Return why the outcome in a seat of a team is hidden; an empty text if it is not."""
        return self.own if self.is_own(team) else self.outcome


def seen_by(
    session: Session,
    matches: Sequence[Match],
    caller: Caller | None,
    results: Mapping[int, datetime] | None = None,
) -> dict[int, Visible]:
    """Return what a caller may see of some matches, by match.

    Args:
        caller: Who asks; None for a stranger.
        results: When the result of each match arrived, if that is known.
    """
    everything = caller is not None and caller.is_organizer
    team = None if caller is None else team_of(session, caller.account)
    name = None if team is None else team.name
    late = _after_freeze(session, matches, results)
    opened = read_state(session, OPENED) is not None
    games = [match for match in matches if match.state in (FINISHED, PLAYING)]
    twins = {} if opened or everything else twins_of(session, games)

    def visible(match: Match) -> Visible:
        not_over = "" if match.state == FINISHED else "the match is not over"
        not_played = "" if match.state == PLAYING else NOT_PLAYED
        if everything:
            return Visible(not_over, not_played, "", "", name, everything)
        suite = "" if match.kind == LADDER or opened else OF_SUITE
        frozen = FROZEN if match.id in late else ""
        record = not_over or frozen or suite or _of_game(match, twins.get(match.id))
        live = not_played or _of_live(session, twins.get(match.id))
        return Visible(record, live, suite or frozen, suite, name, everything)

    return {match.id: visible(match) for match in matches}


def why_live_is_hidden(database: Database, number: int) -> str:
    """Return why strangers may not watch a match now; an empty text if they may."""
    with database.reading() as session:
        return seen_by(session, [find_match(session, number)], None)[number].live


def perhaps_shown(session: Session) -> list[Match]:
    """Return the newest finished matches that everyone may watch as far as their kind and their time say.

    Whether a match can be watched, ``seen_by`` decides, as for any other.
    """
    wanted = select(Match).order_by(Match.id.desc()).limit(NEWEST).options(defer(Match.spec))
    # Most matches are finished, and many of a ladder: from the end, some are found without an index.
    wanted = wanted.where(func.coalesce(Match.state, "") == FINISHED)
    if read_state(session, OPENED) is None:
        wanted = wanted.where(func.coalesce(Match.kind, "") == LADDER)
    since = shown_until(session, None)
    if since is not None:
        shown = select(MatchResult.match_id).where(MatchResult.match_id == Match.id, MatchResult.at <= since)
        wanted = wanted.where(shown.exists())
    return list(session.scalars(wanted))


def is_anything_shown(session: Session, over: Sequence[Match]) -> bool:
    """Return whether everyone may watch any match that is played, or of those of ``perhaps_shown``."""
    newest = [*list_matches(session, state=PLAYING), *over]
    return any("" in (seen.live, seen.record) for seen in seen_by(session, newest, None).values())


def shown_until(session: Session, caller: Caller | None) -> datetime | None:
    """Return until when the history of boards may be seen by a caller; None if all of it may."""
    frozen = None if caller is not None and caller.is_organizer else read_state(session, state.FROZEN)
    if frozen is None or is_finalized(session):
        return None
    return datetime.fromisoformat(str(frozen["at"]))


def audience_of(edition: int) -> str:
    """Return the audience of the board of an edition that is no longer in force."""
    return f"{EDITION}{edition}"


def edition_of_audience(audience: str) -> int | None:
    """Return the edition whose board an audience sees; None if it is that of the edition in force."""
    return int(audience.removeprefix(EDITION)) if audience.startswith(EDITION) else None


def audience_for(caller: Caller | None, asked: str, edition: int | None) -> str:
    """Return the audience of the board that a caller asks for: what is not for everyone is for organizers.

    Args:
        caller: Who asks; None for a stranger.
        asked: An audience of the edition in force.
        edition: The edition, if it is no longer in force: its board is for everyone.

    Raises:
        RefusalError: The caller may not see it.
    """
    if edition is not None:
        return audience_of(edition)
    if asked in (PUBLIC, SEASON):
        return asked
    check_organizer(caller)
    return HIDDEN


def check_organizer(caller: Caller | None) -> Caller:
    """Return a caller who may do privileged acts, and see what is for organizers alone.

    Raises:
        UnknownCallerError: Nobody is logged in.
        ForbiddenError: They may not.
    """
    if caller is None:
        raise UnknownCallerError("only organizers may do this: log in first")
    if not caller.is_organizer:
        raise ForbiddenError("only organizers may do this")
    return caller


def is_own(session: Session, caller: Caller | None, submission: Submission) -> bool:
    """Return whether a submission is of the caller's team, or the caller is an organizer."""
    if caller is None:
        return False
    team = team_of(session, caller.account)
    return caller.is_organizer or (team is not None and team.id == submission.team_id)


def check_own(session: Session, caller: Caller, submission: Submission) -> None:
    """Check that the caller may see, or decide, what is for the team of a submission.

    Raises:
        NotFoundError: The caller may not.
    """
    if not is_own(session, caller, submission):
        raise NotFoundError(f"your team has no submission {submission.id}")


def listed_for(session: Session, caller: Caller | None) -> ColumnElement[bool]:
    """Return which submissions are in lists: of other teams, none that failed or were cancelled."""
    if caller is not None and caller.is_organizer:
        return true()
    team = None if caller is None else team_of(session, caller.account)
    shown = Submission.state.not_in((FAILED, CANCELLED))
    return shown if team is None else or_(shown, Submission.team_id == team.id)


def seat_log(session: Session, season: Season, number: int, seat: int, caller: Caller) -> Path | None:
    """Return the path of what an agent of the caller's team printed in a match; None if it printed nothing.

    Raises:
        NotFoundError: The team has no such seat.
        ForbiddenError: It is hidden.
    """
    match, place = find_match(session, number), session.get(MatchSeat, (number, seat))
    visible = seen_by(session, [match], caller)[number]
    owner = None if place is None else session.get(Submission, place.submission_id or 0)
    if owner is None or not visible.is_own(session.get_one(Team, owner.team_id).name):
        raise NotFoundError(f"your team has no seat {seat} in match {number}")
    if visible.record:
        raise ForbiddenError(visible.record)
    rows = session.get_one(MatchResult, number).row["seats"]
    log = next(one["log"] for one in rows if one["seat"] == seat)
    return None if log is None else season.match_folder(number) / log


def logs_of_notes(
    session: Session, season: Season, number: int, caller: Caller | None
) -> tuple[SeenLog, ...]:
    """Return in which logs a caller may see what agents said and drew.

    Raises:
        NotFoundError: There is no such match.
        ForbiddenError: Its record is hidden, and so is this.
    """
    match = find_match(session, number)
    visible = seen_by(session, [match], caller)[number]
    if visible.record:
        raise ForbiddenError(visible.record)
    logs = {one["seat"]: one["log"] for one in session.get_one(MatchResult, number).row["seats"]}
    owners = select(MatchSeat.seat, Team.name).join(Submission, MatchSeat.submission_id == Submission.id)
    owners = owners.join(Team, Submission.team_id == Team.id).where(MatchSeat.match_id == number)
    is_public = not are_notes_hidden(session, number)
    return tuple(
        SeenLog(season.match_folder(number) / log, seat, visible.is_own(team))
        for seat, team in session.execute(owners)
        if (log := logs.get(seat)) and (is_public or visible.is_own(team))
    )


def are_notes_hidden(session: Session, number: int) -> bool:
    """Return whether an organizer has hidden from other teams what agents said in a match."""
    return str(number) in (read_state(session, state.NOTES_HIDDEN) or {})


def render_key(session: Session, match: int, product: str) -> str:
    """Return the name of a match for what is rendered of it, which is another if it must not show notes."""
    is_quiet = product in {"replay", "video"} and are_notes_hidden(session, match)
    return f"{match}{QUIET if is_quiet else ''}"


def _of_game(match: Match, twin: Twin | None) -> str:
    """Return why a finished match of a ladder is hidden: its map would be known before it is played again."""
    if match.kind != LADDER or twin is None or twin.state in (FINISHED, VOID):
        return ""
    return f"the same game is still to be played again, in other seats, as match {twin.id}"


def _of_live(session: Session, twin: Twin | None) -> str:
    if shown_until(session, None) is not None:
        return FROZEN
    if twin is None or twin.state not in (FINISHED, VOID):
        return "others play the same game later, so it cannot be watched before that"
    return ""


def _after_freeze(
    session: Session, matches: Sequence[Match], results: Mapping[int, datetime] | None
) -> Collection[int]:
    """Return the matches whose results are hidden, since they arrived after the public boards were frozen."""
    since = shown_until(session, None)
    if since is None:
        return set()
    if results is not None:
        return {number for number, at in results.items() if at > since}
    numbers = [match.id for match in matches]
    late = select(MatchResult.match_id).where(MatchResult.match_id.in_(numbers), MatchResult.at > since)
    return set(session.scalars(late))


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


def record_path(session: Session, season: Season, number: int, caller: Caller | None) -> Path:
    """Return the path of a match's record, if the caller may see it.

    Raises:
        NotFoundError: There is no such match, or its record is gone.
        ForbiddenError: It is hidden.
    """
    why = seen_by(session, [find_match(session, number)], caller)[number].record
    if why:
        raise ForbiddenError(why)
    return path_of_record(session, season, number)


def path_of_record(session: Session, season: Season, number: int) -> Path:
    """Return the path of a match's record, whoever asks.

    Raises:
        NotFoundError: The match has no result, or its record is gone.
    """
    result = session.get(MatchResult, number)
    if result is None:
        raise NotFoundError(f"match {number} has no result")
    path = season.match_folder(number) / str(result.row["record"])
    if not path.is_file():
        raise NotFoundError(f"the record of match {number} is no longer in the season's files")
    return path
