"""Following a submission through outages of its season."""

import json
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Any

import pytest
from tests.leaderboard.competing.strange_servers import Answer, http_server

from wildscav.errors import UserError
from wildscav_leaderboard.api.documents import SubmissionView
from wildscav_leaderboard.competing import season_client
from wildscav_leaderboard.competing.connection import Connection
from wildscav_leaderboard.competing.season_client import SeasonClient

NOON = datetime(2030, 6, 1, 12, tzinfo=UTC)
FIRST = SubmissionView(
    id=7,
    team="ants",
    team_title="The Ants",
    name="walker",
    version="1",
    message="",
    tracks=["battle"],
    digest="ab" * 16,
    size=1,
    created=NOON,
    state="submitted",
    since=NOON,
    playing=[],
    kept=False,
    deadline=None,
    charged=True,
    platform_faults=0,
    fault=None,
)


def state(name: str) -> Answer:
    return 200, {}, FIRST.model_copy(update={"state": name}).model_dump_json().encode()


DOWN: Answer = (502, {}, b"<h1>Bad Gateway</h1>")
LATER: Answer = (429, {}, json.dumps({"error": "too many requests: try again in 1 s"}).encode())


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(season_client, "PAUSE", 0.0)


def followed(*answers: Answer) -> Iterator[Any]:
    """What is seen of a submission whose season answers like this."""
    left = list(answers)
    with http_server(lambda _: left.pop(0)) as url, Connection(url, "token") as connection:
        for seen in season_client.follow(SeasonClient(connection), FIRST):
            yield seen.state if isinstance(seen, SubmissionView) else "?"


@pytest.mark.parametrize("last", ["active", "failed", "cancelled", "disabled"])
def test_it_ends_with_the_submission(last: str) -> None:
    assert list(followed(state("queued"), state(last))) == ["submitted", "queued", last]


def test_a_season_that_is_down_or_busy_is_asked_again() -> None:
    seen = list(followed(DOWN, LATER, state("building"), DOWN, state("active")))
    assert seen == ["submitted", "?", "?", "building", "?", "active"]


def test_a_season_that_stays_away_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(season_client, "PATIENCE", 0.0)
    with pytest.raises(UserError, match="is down: HTTP status 502"):
        list(followed(DOWN))


def test_a_refusal_is_the_end() -> None:
    refused = (401, {}, json.dumps({"error": "this token is unknown or revoked"}).encode())
    with pytest.raises(UserError, match="this token is unknown or revoked"):
        list(followed(state("queued"), refused))
