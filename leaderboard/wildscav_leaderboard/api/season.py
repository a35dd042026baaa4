"""The season as it is shown, and the routes."""

from datetime import datetime

from fastapi import APIRouter
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_evaluator.output.results import CURRENT_VERSIONS
from wildscav_leaderboard.access.requests import CurrentSeason, Reading
from wildscav_leaderboard.api.documents import (
    AnnouncementView,
    CountsView,
    SeasonView,
    TrackView,
    ValidationView,
)
from wildscav_leaderboard.database.connection import KEPT
from wildscav_leaderboard.matches.models import FINISHED, Match, MatchResult
from wildscav_leaderboard.matches.service import last_arrival
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import sandbox_of
from wildscav_leaderboard.seasons.models import Announcement
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.service import count_teams


def season_view(session: Session, season: Season) -> SeasonView:
    """Return the season and what the organizers announced."""
    settings, state = season.settings, season_state.state_of(session)
    return SeasonView.about(
        settings,
        commitment=str(season.seed.commitment),
        final_commitment=str(season.final_seed.commitment),
        opened=state.get(season_state.OPENED, {}).get("secret"),
        final_opened=state.get(season_state.OPENED, {}).get("final_secret"),
        paused=state.get(season_state.PAUSED, {}).get("reason"),
        frozen=season_state.FROZEN in state,
        finalized=season_state.FINALIZED in state,
        versions=CURRENT_VERSIONS.model_dump(),
        tracks=[
            TrackView.about(
                track,
                name=name,
                edition=season.numbers.get(name),
                seats=track.seats if track.mode == "ladder" else 1,
            )
            for name, track in settings.tracks.items()
        ],
        announcements=announcement_views(session),
    )


def announcement_views(session: Session) -> list[AnnouncementView]:
    """Return what the organizers announced, the latest first."""
    found = session.scalars(select(Announcement).order_by(Announcement.id.desc()))
    return [AnnouncementView.model_validate(one) for one in found]


def validation_view(session: Session, season: Season) -> ValidationView:
    """Return how submissions are validated."""
    limits = {track: season.limits(track).model_dump(mode="json") for track in season.settings.tracks}
    offers_model = season.settings.model is not None
    return ValidationView(sandbox=sandbox_of(session, season), limits=limits, model=offers_model)


def counts_view(session: Session) -> CountsView:
    """Return how much is going on in the season."""
    submissions = session.scalar(select(func.count()).select_from(Submission)) or 0
    return CountsView(teams=count_teams(session), submissions=submissions, matches=_count_played(session))


def _count_played(session: Session) -> int:
    """Return how many matches have a result. The number is kept until another one arrives."""
    last, kept = last_arrival(session), session.info.get(KEPT, {})
    known: tuple[datetime | None, int] | None = kept.get(MatchResult)
    if known is None or known[0] != last:
        count = session.scalar(select(func.count()).select_from(Match).filter_by(state=FINISHED)) or 0
        known = kept[MatchResult] = last, count
    return known[1]


router = APIRouter(tags=["boards"])


@router.get("/season")
def season(current: CurrentSeason, session: Reading) -> SeasonView:
    """Return the season: its dates, tracks, versions and announcements."""
    more = {"counts": counts_view(session), "validation": validation_view(session, current)}
    return season_view(session, current).model_copy(update=more)


@router.get("/announcements")
def announcements(session: Reading) -> list[AnnouncementView]:
    """Return what the organizers announced, the latest first."""
    return announcement_views(session)
