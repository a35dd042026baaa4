"""A real conductor builds, validates and plays real submissions in real sandboxes."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.evaluator.executors.ray_clusters import ray_cluster
from tests.evaluator.sample_agents import CRASHER, WALKER
from tests.leaderboard.agents import write_agent
from tests.leaderboard.real_conductor import conduct
from tests.leaderboard.seasons_made import changed, make_season, opened, submitted, team_with_member

from wildscav_engine.record import read_record
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_leaderboard.conductor.validators import now
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, LADDER, SUITE, Match, MatchResult
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.state import FAILED, read_state
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import history_of

SUITE_MATCHES = 2  # of navigation in the season of tests


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return make_season(tmp_path / "season", current=True)


@pytest.fixture
def sqlite(season: Season) -> Iterator[Database]:
    with opened(season) as database:
        with database.writing() as session:
            team_with_member(session, "foxes")
        yield database


def hand_in(database: Database, season: Season, folder: Path) -> int:
    with database.writing() as session:
        return submitted(session, season, "foxes", folder, now()).id


def submission_of(session: Session, number: int) -> Submission:
    return session.get_one(Submission, number)


def has_failed(session: Session) -> bool:
    return read_state(session, FAILED) is not None


def finished(session: Session, kind: str = SUITE) -> list[Match]:
    return list(session.scalars(select(Match).filter_by(state=FINISHED, kind=kind).order_by(Match.number)))


# Writes down everything that it is told.
TELLER = (
    """
    def reset(self, match):
        import dataclasses, json
        print(json.dumps(dataclasses.asdict(match)), flush=True)
"""
    + WALKER
)
# What differs from match to match, and so tells nothing.
DRAWN = ("seed", "seat", "team", "start", "target", "supply_waves")


@pytest.mark.slow
def test_a_submission_becomes_active_and_its_matches_are_played(
    sqlite: Database, season: Season, tmp_path: Path
) -> None:
    number = hand_in(sqlite, season, write_agent(tmp_path, "teller", TELLER, '["navigation", "battle"]'))

    def are_played(session: Session) -> bool:
        return len(finished(session)) == SUITE_MATCHES and len(finished(session, LADDER)) >= 2

    conduct(sqlite, season, are_played)

    with sqlite.reading() as session:
        one = submission_of(session, number)
        seen = [entry.state for entry in history_of(session, one)]
        assert seen == ["submitted", "queued", "building", "validating", "active"], one.reason
        for match in finished(session):
            result = session.get_one(MatchResult, match.id)
            path = season.match_folder(match.id) / result.row["record"]
            assert record_digest(path.read_bytes()) == result.record
            record = read_record(path)
            assert record.names[0] == one.entrant
            assert record.seeds == season.seed.private(record.spec, [one.digest])
            assert result.score is not None
        ladder = finished(session, LADDER)
        told = {
            track: [fields for match in matches for fields in told_in(season.match_folder(match.id) / "logs")]
            for track, matches in (("navigation", finished(session)), ("battle", ladder))
        }
    validated = told_in(season.submission_folder(number) / "logs")
    assert sorted(fields["track"] for fields in validated) == ["battle", *["navigation"] * 3]
    for fields in validated:
        for scored in told[fields["track"]]:
            assert without_drawn(fields) == without_drawn(scored)
    seeds = {fields["seed"] for fields in (*validated, *told["navigation"], *told["battle"])}
    assert len(seeds) == 2 + SUITE_MATCHES + len(ladder)  # the three trials on navigation are of one match


def told_in(logs: Path) -> list[dict[str, Any]]:
    """What agents were told, as they wrote it down first of all."""
    return [json.loads(path.read_text().splitlines()[0]) for path in sorted(logs.glob("*.log"))]


def without_drawn(fields: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if name not in DRAWN}


# Its validation takes two minutes: 25 s to get ready for each of four matches, and 50 ms for each step.
SLOW_START = """
    def reset(self, match):
        time.sleep(25.0)

    def act(self, observation):
        time.sleep(0.05)
        return Action()
"""


@pytest.mark.slow
def test_a_slow_submission_holds_up_neither_others_nor_matches(
    sqlite: Database, season: Season, tmp_path: Path
) -> None:
    slow = hand_in(sqlite, season, write_agent(tmp_path, "waiting", SLOW_START))
    hand_in(sqlite, season, write_agent(tmp_path, "walker"))

    seen: list[str] = []

    def is_played(session: Session) -> bool:
        seen.append(submission_of(session, slow).state)
        return bool(finished(session))

    conduct(sqlite, season, is_played)
    assert seen[-1] == "validating"
    with sqlite.reading() as session:
        assert submission_of(session, slow).state == "queued"  # the conductor was stopped


@pytest.mark.slow
def test_what_fails_says_whose_fault_it_was(sqlite: Database, season: Season, tmp_path: Path) -> None:
    lost = hand_in(sqlite, season, write_agent(tmp_path, "walker"))
    for path in season.archives.iterdir():
        path.unlink()
    number = hand_in(sqlite, season, write_agent(tmp_path, "crasher", CRASHER))

    def are_over(session: Session) -> bool:
        return {submission_of(session, one).state for one in (lost, number)} == {"failed"}

    conduct(sqlite, season, are_over)

    with sqlite.reading() as session:
        one = submission_of(session, lost)
        assert (one.fault, one.charged, one.platform_faults) == ("platform", False, 3)
        one = submission_of(session, number)
        assert (one.fault, one.charged) == ("agent", True)
        assert one.reason.startswith("match: navigation: crashed")
        assert any("lost the thread" in line for line in one.last_lines)
        assert any('File "agent.py"' in line for line in one.last_lines)
        assert one.command == f"wildscav check DIR --season {season.settings.web.address}"


def test_a_season_without_the_key_of_its_model_says_so(season: Season, sqlite: Database) -> None:
    model = ModelSettings(url="http://host/v1", name="tiny", key_env="NO_SUCH_KEY")
    conduct(sqlite, changed(season, model=model), has_failed)

    with sqlite.reading() as session:
        assert "the variable NO_SUCH_KEY, which" in (read_state(session, FAILED) or {})["reason"]


def on_ray(season: Season, address: str) -> Season:
    execution = season.settings.execution.model_copy(update={"executor": "ray", "address": address})
    return changed(season, execution=execution)


@pytest.mark.slow
def test_a_season_is_played_on_a_cluster(
    sqlite: Database, season: Season, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = hand_in(sqlite, season, write_agent(tmp_path, "walker"))
    with ray_cluster("node") as cluster:
        cluster.use(monkeypatch)
        conduct(sqlite, on_ray(season, cluster.address), lambda session: bool(finished(session)))

    with sqlite.reading() as session:
        assert submission_of(session, number).state == "active"
        match = finished(session)[0]
        result = session.get_one(MatchResult, match.id)
        record = (season.match_folder(match.id) / result.row["record"]).read_bytes()
        assert record_digest(record) == result.record


def test_a_season_on_a_cluster_says_why_it_cannot_play(season: Season, sqlite: Database) -> None:
    conduct(sqlite, on_ray(season, "127.0.0.1:1"), has_failed)

    with sqlite.reading() as session:
        reason = "there is no Ray cluster at 127.0.0.1:1: Connection refused"
        assert read_state(session, FAILED) == {"reason": reason}
