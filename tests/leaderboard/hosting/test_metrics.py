"""What an organizer's Prometheus sees, and what stands in the log."""

import json
import operator
import re
import threading
import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families
from tests.leaderboard.agents import write_agent
from tests.leaderboard.hosting.clients import serving
from tests.leaderboard.seasons_made import make_season, opened, submitted, team_with_member

from wildscav_evaluator.executors import ExecutorError
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.conductor.lease import acquire, release
from wildscav_leaderboard.database.connection import Database, clock
from wildscav_leaderboard.hosting.metrics import SeasonMetrics
from wildscav_leaderboard.hosting.request_log import WebCounts
from wildscav_leaderboard.organizing.status import status
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.state import RESTARTS, write_state
from wildscav_leaderboard.webhooks.service import add_webhook, queue_message, remove_webhook
from wildscav_server.monitoring.logs import open_log
from wildscav_server.monitoring.metrics import serving_metrics


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return make_season(tmp_path / "season", current=True)


@pytest.fixture
def database(season: Season) -> Iterator[Database]:
    with opened(season) as database:
        yield database


ALERTS = (Path(__file__).parents[3] / "docker" / "alerts.yaml").read_text("utf-8")


def exposition(season: Season, database: Database, counts: WebCounts) -> str:
    with serving_metrics(SeasonMetrics(season, database, counts), 0) as address:
        assert address is not None
        return httpx.get(address, timeout=60.0).text


def scraped(season: Season, database: Database, counts: WebCounts) -> dict[tuple[str, ...], float]:
    """What Prometheus reads: each value by its name and its labels."""
    families = text_string_to_metric_families(exposition(season, database, counts))
    return {(one.name, *one.labels.values()): one.value for family in families for one in family.samples}


def test_the_alerts_are_about_metrics_that_there_are(season: Season, database: Database) -> None:
    told = set(re.findall(r"wildscav_season_\w+", ALERTS))
    named = set(
        re.findall(r"^# TYPE (wildscav_season_\w+) ", exposition(season, database, WebCounts()), re.M)
    )
    assert len(told) == 4
    assert told <= named


def test_what_waits_and_what_broke_is_seen(season: Season, database: Database, tmp_path: Path) -> None:
    long_ago = datetime.now(UTC) - timedelta(minutes=10)
    with database.writing() as session:
        foxes, _ = team_with_member(session, "foxes")
        submitted(session, season, "foxes", write_agent(tmp_path, "fox"), datetime.now(UTC))
        add_webhook(session, foxes, "https://example.org/", long_ago)
        queue_message(session, foxes.id, "submission.active", {}, long_ago)
        write_state(session, RESTARTS, {"webhooks": 3}, long_ago)
    seen = scraped(season, database, WebCounts())
    expected = {
        ("submissions", "submitted"): 1,
        ("conductor_up",): 0,
        ("database_up",): 1,
        ("paused",): 0,
        ("restarts_total", "webhooks"): 3,
    }
    assert {key: seen[f"wildscav_season_{key[0]}", *key[1:]] for key in expected} == expected
    assert seen["wildscav_season_webhooks_overdue_seconds",] >= 600


def alerts(seen: dict[tuple[str, ...], float]) -> set[str]:
    """Return which of the alerts that the documentation suggests would fire."""
    found = re.findall(r"alert: (\w+), expr: (\w+) (==|>|<) ([\de]+)", ALERTS)
    assert len(found) == 4
    compare = {"==": operator.eq, ">": operator.gt, "<": operator.lt}
    values = [(key[0], value) for key, value in seen.items()]
    return {
        name
        for name, of, sign, than in found
        for key, value in values
        if key == of and compare[sign](value, float(than))
    }


@pytest.mark.slow
def test_the_alerts_fire_when_nothing_is_played_or_sent_and_else_do_not(
    season: Season, database: Database, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    conductor = Conductor(season, database)

    def fails(*_: object) -> str:
        conductor.stop()
        raise ExecutorError("no node of the Ray cluster is left")

    with monkeypatch.context() as patched:
        patched.setattr("wildscav_leaderboard.conductor.work.chosen_sandbox", fails)
        conductor.run()
    with database.writing() as session:
        holding = acquire(session, "another one, which tries too", clock(session))
        assert holding is not None  # the first one gave it back
        foxes, _ = team_with_member(session, "foxes")
        webhook = add_webhook(session, foxes, "https://example.org/", datetime.now(UTC))
        queue_message(session, foxes.id, "submission.active", {}, datetime.now(UTC) - timedelta(minutes=10))
        assert status(session, season, datetime.now(UTC)).failed == "no node of the Ray cluster is left"
    assert alerts(scraped(season, database, WebCounts())) == {"NothingIsPlayed", "WebhooksWait"}

    with database.writing() as session:
        release(session, holding, clock(session))
        remove_webhook(session, foxes, webhook.id)
    conductor = Conductor(season, database)
    conducting = threading.Thread(target=conductor.run)
    conducting.start()
    while alerts(scraped(season, database, WebCounts())) and conducting.is_alive():
        time.sleep(0.05)
    assert alerts(scraped(season, database, WebCounts())) == set()
    conductor.stop()
    conducting.join()

    lost = Database(f"sqlite:///{tmp_path / 'no' / 'folder' / 'season.db'}")
    seen = scraped(season, lost, WebCounts())
    assert alerts(seen) == {"NoDatabase"}
    assert alerts({**seen, ("wildscav_season_disk_free_bytes", "cache"): 1e9}) == {"NoDatabase", "DiskFills"}


def test_a_database_that_does_not_answer_is_seen(season: Season, tmp_path: Path) -> None:
    lost = Database(f"sqlite:///{tmp_path / 'no' / 'folder' / 'season.db'}")
    seen = scraped(season, lost, WebCounts())
    disks = {key for key in seen if key[0] == "wildscav_season_disk_free_bytes"}
    assert {key: seen[key] for key in seen.keys() - disks} == {
        ("wildscav_season_database_up",): 0,
        ("wildscav_season_tables",): 0,
    }


def test_requests_are_counted_by_route_and_not_by_address(season: Season, database: Database) -> None:
    counts = WebCounts()
    with serving(season, database, counts=counts) as (_, client):
        for path in ("/matches/1", "/matches/2", "/api/v1/matches/3", "/static/season.css", "/no/1", "/no/2"):
            client.get(path)
    seen = scraped(season, database, counts)
    total = "wildscav_season_requests_total"
    assert seen[total, "GET", "/matches/{number}", "404"] == 2
    assert seen[total, "GET", "/api/v1/matches/{match}", "404"] == 1
    assert seen[total, "GET", "/static", "200"] == 1
    assert seen[total, "GET", "unknown", "404"] == 2
    assert seen["wildscav_season_request_seconds_count", "/matches/{number}"] == 2


def test_the_log_has_a_line_for_every_request_and_no_secrets(
    season: Season, database: Database, capsys: pytest.CaptureFixture[str]
) -> None:
    with serving(season, database, log=open_log("json", process="web")) as (_, client):
        client.get("/api/v1/me?token=top-secret", headers={"Authorization": "Bearer top-secret"})
        client.post("/api/v1/tokens", json={"name": "anna", "password": "top-secret"})
    said = capsys.readouterr().err
    assert "top-secret" not in said
    lines = [json.loads(line) for line in said.splitlines()]
    seen = [(one["event"], one["process"], one["method"], one["path"], one["status"]) for one in lines]
    assert seen == [
        ("request", "web", "GET", "/api/v1/me", 401),
        ("request", "web", "POST", "/api/v1/tokens", 401),
    ]
    assert all(one["milliseconds"] > 0 and one["address"] == "127.0.0.1" for one in lines)


def test_an_error_that_nobody_expected_is_logged_and_answered_by_one_line(
    season: Season, database: Database, capsys: pytest.CaptureFixture[str]
) -> None:
    def breaks() -> None:
        raise ZeroDivisionError("nobody expected this")

    with serving(season, database, log=open_log("json")) as (app, client):
        app.add_api_route("/api/v1/breaks", breaks)
        answer = client.get("/api/v1/breaks")
    assert answer.status_code == 500
    assert answer.json()["error"] == "something went wrong here: the organizers can see what"
    assert "Content-Security-Policy" in answer.headers
    first = json.loads(capsys.readouterr().err.splitlines()[0])
    assert first["event"] == "request_broke"
    assert "ZeroDivisionError: nobody expected this" in first["trace"]
