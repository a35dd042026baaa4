"""What organizers do through the API, and that nobody else can."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import httpx
import pytest
from tests.leaderboard.agents import write_agent
from tests.leaderboard.hosting.clients import serving
from tests.leaderboard.seasons_made import make_account, make_season, opened, submitted, team_with_member

from wildscav_leaderboard.accounts.models import COMPETITOR, ORGANIZER
from wildscav_leaderboard.accounts.service import new_token


class Callers(NamedTuple):
    """Clients of a season's API, by who asks."""

    client: httpx.Client
    tokens: dict[str, str]

    def ask(self, who: str, method: str, path: str, content: object = None) -> httpx.Response:
        headers = {"Authorization": f"Bearer {self.tokens[who]}"}
        return self.client.request(method, f"/api/v1{path}", json=content, headers=headers)

    def act(self, path: str, content: object = None) -> httpx.Response:
        answer = self.ask("olga", "POST", f"/organizer{path}", content)
        assert answer.is_success, answer.text
        return answer


@pytest.fixture
def callers(tmp_path: Path) -> Iterator[Callers]:
    """A season with an organizer, olga, and a team with a submission, whose captain is a competitor."""
    season, now = make_season(tmp_path / "season", current=True), datetime.now(UTC)
    with opened(season) as database:
        with database.writing() as session:
            _, captain = team_with_member(session, "foxes")
            olga = make_account(session, "olga", ORGANIZER)
            submitted(session, season, "foxes", write_agent(tmp_path, "fox"), now)
            tokens = {who.name: new_token(session, who, "test", now) for who in (olga, captain)}
        with serving(season, database) as (_, client):
            yield Callers(client, tokens)


def test_every_act_is_entered_in_the_audit_log_with_who_did_it_and_why(callers: Callers) -> None:
    callers.act("/pause", {"reason": "a new disk"})
    assert callers.act("/announcements", {"title": "Welcome", "text": "Good luck!"}).status_code == 204
    callers.act("/resume")
    callers.act("/submissions/1/disqualify", {"reason": "it reads the map"})
    callers.act("/teams/foxes/disqualify", {"reason": "two teams of one person"})
    callers.act("/freeze")
    entries = callers.ask("olga", "GET", "/organizer/audit-log").json()
    assert [(one["actor"], one["act"], one["subject"], one["detail"]) for one in reversed(entries)] == [
        ("olga", "pause", "season", "a new disk"),
        ("olga", "announce", "announcement 'Welcome'", ""),
        ("olga", "resume", "season", ""),
        ("olga", "disqualify submission", "submission 1", "it reads the map"),
        ("olga", "disqualify team", "team foxes", "two teams of one person"),
        ("olga", "freeze", "boards", ""),
    ]
    seen = callers.client.get("/api/v1/submissions/1").json()
    assert (seen["state"], seen["reason"]) == ("cancelled", "disqualified: it reads the map")
    older = callers.ask("olga", "GET", f"/organizer/audit-log?before={entries[1]['id']}&limit=2").json()
    assert older == entries[2:4]


def test_the_status_tells_that_nobody_conducts_and_what_waits(callers: Callers) -> None:
    seen = callers.ask("olga", "GET", "/organizer/status").json()
    assert seen["conductor"] is None
    assert seen["submissions"] == {"submitted": 1}
    assert seen["teams"] == 1
    assert seen["faults"] == []


def test_an_invitation_registers_as_many_as_it_says_and_in_its_role(callers: Callers) -> None:
    key = callers.act("/invitations", {"label": "jury", "role": "organizer"}).json()["key"]
    new = {"name": "jill", "password": "correct horse battery", "invitation": key}
    made = callers.client.post("/api/v1/accounts", json=new)
    assert made.json()["role"] == ORGANIZER
    again = callers.client.post("/api/v1/accounts", json=new | {"name": "jack"})
    assert again.status_code == 403, again.text


@pytest.mark.parametrize(
    ("path", "content", "status"),
    [
        ("/submissions/1/rerun", None, 409),
        ("/submissions/9/rerun", None, 404),
        ("/submissions/1/disqualify", {"reason": ""}, 422),
        ("/teams/wolves/disqualify", {"reason": "why not"}, 404),
        ("/invitations", {"role": COMPETITOR, "uses": 0}, 422),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line(
    callers: Callers, path: str, content: object, status: int
) -> None:
    refused = callers.ask("olga", "POST", f"/organizer{path}", content)
    assert (refused.status_code, refused.json()["error"].count("\n")) == (status, 0)
    assert callers.ask("olga", "GET", "/organizer/audit-log").json() == []
