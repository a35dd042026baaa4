"""Who asks the application in tests, and how: a program with a token, or a browser with a cookie."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import httpx
from fastapi import FastAPI
from sqlalchemy import select
from tests.leaderboard.filled_season import COOKIE, FilledSeason, Person

from wildscav_leaderboard.accounts.models import Account, Token
from wildscav_leaderboard.database.connection import Database


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
    form = {"content": body} if isinstance(body, str) else {"data": form_of(person, body)}
    return client.request(method, path, headers=headers, **form)


def form_of(person: Person | None, fields: dict[str, str]) -> dict[str, str]:
    """Return the fields of a form as the person's own page sends it."""
    return {**fields, "csrf": "none" if person is None else person.csrf}


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
