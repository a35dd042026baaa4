"""Who asks the application in tests, and how: a program with a token, or a browser with a cookie."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import httpx
from fastapi import FastAPI
from sqlalchemy import select
from tests.leaderboard.filled_season import COOKIE, FilledSeason
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.accounts.models import Account, Token
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.seasons.folder import Season


@contextmanager
def serving(
    season: Season, database: Database, *, renders: bool = True, **more: Any
) -> Iterator[tuple[FastAPI, httpx.Client]]:
    """Serve a season, and give the application and a client of it; perhaps it can render nothing."""
    app = create_app(season, database, **more)
    with closing(app.state.renders), closing(app.state.tables):
        if not renders:
            app.state.renders.close()
        with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
            yield app, client


class Site(NamedTuple):
    """A filled season that is served."""

    filled: FilledSeason
    app: FastAPI
    client: httpx.Client

    def ask(self, asker: str, path: str, method: str = "GET", body: Any = None) -> httpx.Response:
        """Send a request for somebody; see ``ask``. The path has places for what is in the season."""
        named = path.format(**self.filled.submissions, **self.filled.matches)
        return ask(self.client, self.filled, asker, method, named, body)


@contextmanager
def serving_filled(filled: FilledSeason, *, renders: bool = True) -> Iterator[Site]:
    """Serve a filled season."""
    with serving(filled.season, filled.database, renders=renders) as (app, client):
        yield Site(filled, app, client)


def ask(
    client: httpx.Client, filled: FilledSeason, asker: str, method: str, path: str, body: Any = None
) -> httpx.Response:
    """Send a request for somebody as their program or browser would, and return the answer.

    Args:
        client: Of the application.
        filled: The season.
        asker: ``visitor``, or a name in ``filled.people``.
        method: HTTP method.
        path: The path and query.
        body: JSON or text for the API; the fields of a form, or text, for a page.
    """
    person = filled.people.get(asker)
    if path.startswith("/api/"):
        headers = {} if person is None else {"Authorization": f"Bearer {person.token}"}
        sent = {"content": body} if isinstance(body, str) else {"json": body}
        return client.request(method, path, headers=headers, **(sent if body is not None else {}))
    headers = {} if person is None else {"Cookie": f"{COOKIE}={person.cookie}", "X-CSRF": person.csrf}
    if body is None:
        return client.request(method, path, headers=headers)
    form = (
        {"content": body}
        if isinstance(body, str)
        else {"data": {**body, "csrf": "none" if person is None else person.csrf}}
    )
    return client.request(method, path, headers=headers, **form)


def numbers_of(filled: FilledSeason) -> dict[str, int]:
    """Return the numbers that stand in the table's paths."""
    with filled.database.reading() as session:
        token = session.scalars(
            select(Token.id).join(Account, Account.id == Token.account_id).where(Account.name == "owls")
        ).one()
    return {**filled.submissions, **filled.matches, "owners_token": token}


@contextmanager
def copied_database(app: FastAPI, filled: FilledSeason, folder: Path) -> Iterator[Path]:
    """Let the application use a fresh copy of the season's database, so that what changes there is forgotten.

    Gives the path of the copy.
    """
    source, copy = Path(str(filled.database.url.database)), folder / "copy.db"
    copy.unlink(missing_ok=True)
    with closing(sqlite3.connect(source)) as one, closing(sqlite3.connect(copy)) as other:
        other.execute("PRAGMA synchronous = OFF")
        one.backup(other)
    database = app.state.database = Database(f"sqlite:///{copy}")
    try:
        yield copy
    finally:
        app.state.database = filled.database
        database.close()
