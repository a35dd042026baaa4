"""Against which submissions people may play, as the organizer allows it."""

from collections.abc import Sequence

from sqlalchemy.orm import Session

from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.states import ACTIVE
from wildscav_leaderboard.teams.models import Team


def open_tracks(season: Season) -> tuple[str, ...]:
    """Return the tracks of a season on which people may play."""
    play = season.settings.play
    if not play.enabled:
        return ()
    return tuple(track for track in season.settings.tracks if not play.tracks or track in play.tracks)


def tracks_of(season: Season, state: str, tracks: Sequence[str]) -> tuple[str, ...]:
    """Return the tracks on which people may play against a submission in a state."""
    return tuple(track for track in open_tracks(season) if track in tracks) if state == ACTIVE else ()


def refused_why(session: Session, season: Season, submission: Submission, track: str) -> str:
    """Return why people may not play against a submission on a track; an empty text if they may."""
    if not season.settings.play.enabled:
        return "in this season nobody plays against submissions"
    if track not in open_tracks(season):
        return f"in this season people play on {', '.join(open_tracks(season))}"
    team = session.get_one(Team, submission.team_id)
    if submission.state != ACTIVE or team.disqualified is not None:
        state = "disqualified" if team.disqualified is not None else submission.state
        return f"submission {submission.id} is {state}: only those that take part can be played against"
    return "" if track in submission.playing else f"submission {submission.id} does not play {track}"
