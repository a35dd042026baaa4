"""A season whose matches are played in this process, by simple policies: real records, real services."""

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.leaderboard.agents import write_agent
from tests.leaderboard.seasons_made import NOON, make_season, submitted, team_with_member

from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match as Game
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_evaluator.output.results import MatchRow, MatchTiming, SeatRow, metric_infos
from wildscav_evaluator.seats import display_names
from wildscav_leaderboard.boards.service import after_boards, refresh
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.plans import plan_ladders, plan_suites
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import LADDER, WAITING, Match, MatchSeat
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.matches.service import PlayedRecord, deliver, seats_of
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import move

RECORD = "records/match.wsr"
TEAMS = ("foxes", "owls", "hares")
RICH = "supplies = { waves = [{ center = [0, 0], radius = 30, outdoor_richness = 50 }] }"


def play_season(folder: Path) -> None:
    """Make a season in which the submission of each team has played on both tracks."""
    season = make_season(folder / "season", "matches = 6\nwaiting = 2")
    for name, old, new in (
        ("tiny.toml", "maps = 2", "maps = 6"),
        ("tiny.toml", "match = { time_limit = 4, seats", f"match = {{ {RICH}, time_limit = 4, seats"),
        ("season.toml", "seats = 2", "seats = 4"),
    ):
        path = season.folder / name
        path.write_text(path.read_text().replace(old, new))
    for name in (SECRET_FILE, FINAL_SECRET_FILE):  # so that the same happens each time
        (season.folder / name).write_text(f"a secret of 32 bytes or more: {name}")
    season = Season.open(season.folder)
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        begin_editions(session, season, NOON)
        for index, team in enumerate(TEAMS):
            team_with_member(session, team)
            enter(session, season, team, folder / "agents", index)
    play_everything(database, season, NOON + timedelta(hours=1))
    database.close()


def enter(session: Session, season: Season, team: str, agents: Path, index: int) -> int:
    """Let a team's submission take part."""
    folder = write_agent(agents, f"{team}-agent", tracks='["navigation", "battle"]')
    (folder / "notes.txt").write_text(team)
    when = NOON + timedelta(minutes=index)
    one = submitted(session, season, team, folder, when)
    for state in (states.QUEUED, states.BUILDING, states.VALIDATING, states.ACTIVE):
        move(session, one, state, when)
    plan_suites(session, season, one, when)
    return one.id


def play_everything(database: Database, season: Season, now: datetime) -> None:
    """Play whatever waits, a second each, and bring the boards up to date now and then, and at the end."""
    for second in range(1000):
        with database.writing() as session:
            plan_ladders(session, season, now)
            match = session.scalars(
                select(Match).filter_by(state=WAITING).order_by(Match.priority, Match.id).limit(1)
            ).first()
            moment = now + timedelta(seconds=second)
            if match is None or second % 6 == 5:
                refresh(session, season, moment)
            if match is None:
                return
            play(session, season, match, moment)


def play(session: Session, season: Season, match: Match, now: datetime) -> None:
    """Play a match, and deliver its result."""
    seats = seats_of(session, [match.id])[match.id]
    game = Game(MatchSpec.model_validate(match.spec))
    told = [seat for seat in seats if seat.submission_id is not None]
    digests = [session.get_one(Submission, seat.submission_id).digest for seat in told]
    secret = season.final_seed if match.decides else season.seed
    seeds = secret.private(game.spec, digests)
    game.seeds = {seat.seat: seed for seat, seed in zip(told, seeds, strict=True)}
    while not game.over:
        game.step(_actions(game, seats))
    names = [seat.entrant for seat in told]
    robots = [seat.seat for seat in seats if seat.submission_id is None]
    path = season.match_folder(match.id) / RECORD
    path.parent.mkdir(parents=True, exist_ok=True)
    write_record(path, game, display_names(game.spec.seats, names, robots))
    rows = tuple(_row(game, seat, is_ladder=match.kind == LADDER) for seat in seats)
    deliver(
        session,
        match,
        None,
        MatchRow.of(match.number, rows, RECORD),
        MatchTiming(
            submission=None, track=match.track, index=match.number, started=0, wall=1, steps=1, seats=()
        ),
        PlayedRecord(record_digest(path.read_bytes()), path.stat().st_size),
        metric_infos(match.track)[0],
        after_boards(session, now),
    )


def _row(game: Game, seat: MatchSeat, *, is_ladder: bool) -> SeatRow:
    return SeatRow(
        seat=seat.seat,
        submission=seat.entrant if is_ladder else None,
        team=game.spec.team_of_seats[seat.seat] if is_ladder else None,
        status="finished",
        detail="what an agent printed",
        metrics=dict(game.result().seats[seat.seat].metrics),
    )


def _actions(game: Game, seats: list[MatchSeat]) -> np.ndarray:
    """Let every submission walk in its own way, some more and some less."""
    actions = np.zeros((game.seats, FIELDS), np.float32)
    for seat in seats:
        if game.spec.seats[seat.seat] == SUBMISSION:
            own = seat.submission_id or 0
            actions[seat.seat, Field.WALK_DIRECTION] = (37 * own + 11 * game.step_number) % 360
            actions[seat.seat, Field.WALK_SPEED] = 2.0 + own
            actions[seat.seat, Field.PICK_UP] = 1.0
    return actions


def end_season(database: Database, season: Season) -> None:
    """End the season: the final matches are played, the boards become final, and the secrets are opened."""
    late = season.settings.closes + timedelta(days=1)
    with database.writing() as session:
        finalizing.begin(session, season, "anna", 2, late, early=False)
    for stage in (finalizing.DECIDING, finalizing.DONE):
        with database.writing() as session:
            assert finalizing.advance(session, season, "anna", late).stage == stage
        play_everything(database, season, late)
