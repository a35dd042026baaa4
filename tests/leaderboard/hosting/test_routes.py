"""Who may use which route: all of them are asked by everyone, and what changes is forgotten at once."""

import io
import logging
from collections.abc import Iterator
from contextlib import nullcontext
from html import escape
from typing import NamedTuple

import httpx
import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from sqlalchemy import QueuePool, select
from starlette.routing import WebSocketRoute
from starlette.types import Message, Receive, Scope, Send
from tests.leaderboard.filled_season import HOSTILE, FilledSeason
from tests.leaderboard.hosting.clients import ask, copied_database, numbers_of
from tests.leaderboard.hosting.route_table import ASKING, LOG_IN, TABLE, Line
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.accounts.models import Account, Invitation, Token, WebSession
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.matches.models import SUITE, Match
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.webhooks.models import Webhook

pytestmark = pytest.mark.slow
NO_METHODS = {"FILES": "GET", "SOCKET": "GET"}  # of the table, and how they are asked
API_KINDS = ("application/json", "application/x-ndjson", "application/octet-stream", "text/plain")


class Answer(NamedTuple):
    """What somebody was answered."""

    line: Line
    asker: str
    response: httpx.Response


class Walk(NamedTuple):
    """The answers of all routes to everyone, and what was logged meanwhile."""

    app: FastAPI
    filled: FilledSeason
    answers: list[Answer]
    log: str
    holding: set[str]  # paths whose answers were sent while a connection to the database was held


@pytest.fixture(scope="module")
def walk(hostile_season: FilledSeason, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Walk]:
    filled, folder = hostile_season, tmp_path_factory.mktemp("walk")
    numbers = numbers_of(filled)
    app, logged = create_app(filled.season, filled.database), logging.StreamHandler(io.StringIO())
    app.state.renders.close()  # so that nobody waits for what cannot be rendered
    logging.getLogger().addHandler(logged)
    answers = []
    holding: set[str] = set()
    with served(_Watched(app, holding)) as address, httpx.Client(base_url=address, timeout=60.0) as client:
        for line in TABLE:
            method, path = NO_METHODS.get(line.method, line.method), line.path.format(**numbers)
            for asker in ASKING:
                with nullcontext() if method == "GET" else copied_database(app, filled, folder):
                    answers.append(Answer(line, asker, ask(client, filled, asker, method, path, line.body)))
        yield Walk(app, filled, answers, logged.stream.getvalue(), holding)
    logging.getLogger().removeHandler(logged)


class _Watched:
    """Notes for which paths a connection to the database is held while the body is sent."""

    def __init__(self, app: FastAPI, holding: set[str]) -> None:
        self._app, self._holding = app, holding

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def watch(message: Message) -> None:
            if message["type"] == "http.response.body" and _connections(self._app.state.database):
                self._holding.add(scope["path"])
            await send(message)

        await self._app(scope, receive, watch)


def _connections(database: Database) -> int:
    """Return how many connections for reading are in use."""
    pool = database._readers.pool
    assert isinstance(pool, QueuePool)
    return pool.checkedout()


def test_every_route_has_a_line(walk: Walk) -> None:
    routes = set()
    for route in iter_route_contexts(walk.app.routes):
        other = "SOCKET" if isinstance(route.original_route, WebSocketRoute) else "FILES"
        for method in set(getattr(route, "methods", None) or {other}) - {"HEAD"}:
            routes.add(f"{method} {getattr(route, 'path', '')}")
    assert {line.route for line in TABLE} == routes


def test_everyone_gets_what_the_table_says(walk: Walk) -> None:
    wrong = [
        f"{line.method} {line.path} as {asker}: {response.status_code} {response.text[:200]}"
        for line, asker, response in walk.answers
        if response.status_code != line.statuses[ASKING.index(asker)]
    ]
    assert not wrong, "\n".join(wrong)


def test_no_answer_holds_a_connection_to_the_database_while_it_is_sent(walk: Walk) -> None:
    assert walk.holding == set()


def test_whoever_is_not_logged_in_is_sent_to_do_that(walk: Walk) -> None:
    for line, asker, response in walk.answers:
        if asker == "visitor" and line.is_page and response.status_code == LOG_IN and "log" not in line.path:
            expected = "/account" if line.route == "POST /register" else "/login"
            assert response.headers["location"].partition("?")[0] == expected, line


def test_what_people_and_agents_write_is_text_on_every_page(walk: Walk) -> None:
    kinds = ("text/html", "application/atom+xml", "image/svg+xml")
    pages = [one for one in walk.answers if one.response.headers.get("content-type", "").startswith(kinds)]
    for line, asker, response in pages:
        assert "<script>alert(" not in response.text, (line.path, asker)
        assert not set("\x1b\x07\u202e") & set(response.text), (line.path, asker)
    shown = "".join(answer.response.text for answer in pages)
    for word in HOSTILE:
        first = word.splitlines()[0].partition("\x1b")[0]
        assert escape(first).replace("&#x27;", "&#39;").replace("&quot;", "&#34;") in shown, word


def test_answers_of_the_api_are_no_pages(walk: Walk) -> None:
    for line, asker, response in walk.answers:
        if not line.is_page and response.content:
            kind = response.headers["content-type"].partition(";")[0]
            assert kind in API_KINDS, line
            assert response.headers["x-content-type-options"] == "nosniff", line
            assert b"\x1b" not in response.content, (line.path, asker)


def test_no_answer_and_no_log_holds_a_secret(walk: Walk) -> None:
    secrets = _secrets(walk.filled)
    for line, asker, response in walk.answers:
        person = walk.filled.people.get(asker)
        own = {person.csrf} if person is not None else set()
        told = [name for name, secret in secrets if secret not in own and secret in response.text]
        assert told == [], (line.path, asker)
        assert "$argon2" not in response.text
    assert [name for name, secret in secrets if secret in walk.log] == []


def _secrets(filled: FilledSeason) -> list[tuple[str, str]]:
    found = [("the season's secret", (filled.season.folder / "secret.txt").read_text().strip())]
    found += [("the season's seed", str(filled.season.seed.value))]
    for person in filled.people.values():
        found += [("a token", person.token), ("a cookie", person.cookie), ("a form's token", person.csrf)]
    columns = (
        *(Account.password, Token.digest, WebSession.digest, Invitation.digest, Team.join_digest),
        Webhook.secret,
    )
    with filled.database.reading() as session:
        for column in columns:
            found += [(str(column), value) for value in session.scalars(select(column))]
        for spec in session.scalars(select(Match.spec).where(Match.kind == SUITE)):
            found += [
                ("a hidden match's seed", str(spec["seed"])),
                ("a map's seed", str(spec["map"]["seed"])),
            ]
    return found


def test_every_page_has_the_headers_that_keep_other_sites_out(walk: Walk) -> None:
    for line, asker, response in walk.answers:
        policy = response.headers["content-security-policy"]
        assert "default-src" in policy, (line.path, asker)
        assert "unsafe-inline" not in policy, (line.path, asker)
        assert response.headers["x-content-type-options"] == "nosniff", (line.path, asker)
