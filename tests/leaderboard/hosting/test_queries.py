"""How often a page asks the database: few times, however many tracks and matches it shows."""

from collections.abc import Iterator

import httpx
import pytest
from sqlalchemy import event
from sqlalchemy.engine import Engine
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.hosting.clients import ask
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.hosting.app import create_app

MAX_QUERIES = 10  # queries of a page
MORE_IF_LOGGED_IN = 3  # who it is, of which team, and what that team alone sees


@pytest.fixture(scope="module")
def client(hostile_season: FilledSeason) -> Iterator[httpx.Client]:
    app = create_app(hostile_season.season, hostile_season.database)
    with served(app) as address, httpx.Client(base_url=address, timeout=60.0) as client:
        yield client
    app.state.renders.close()


@pytest.fixture
def asked() -> Iterator[list[str]]:
    """The queries that are sent to any database."""
    found: list[str] = []

    def note(_connection, _cursor, statement, *_others) -> None:
        if statement.lstrip().startswith("SELECT"):
            found.append(statement)

    event.listen(Engine, "before_cursor_execute", note)
    yield found
    event.remove(Engine, "before_cursor_execute", note)


@pytest.mark.parametrize("asker", ["visitor", "owner", "organizer"])
@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/boards/navigation",
        "/boards/battle",
        "/teams/owls",
        "/submissions/{active}",
        "/submissions/{queued}",
        "/matches",
        "/matches?track=battle&team=owls",
        "/matches/{suite}",
        "/matches/{ladder}",
        "/matches/{playing}",
    ],
)
def test_a_page_asks_the_database_few_times(
    client: httpx.Client, hostile_season: FilledSeason, asked: list[str], asker: str, path: str
) -> None:
    page = path.format(**hostile_season.submissions, **hostile_season.matches)
    ask(client, hostile_season, asker, "GET", page)  # what is parsed once is kept
    asked.clear()
    answer = ask(client, hostile_season, asker, "GET", page)

    assert answer.status_code == 200
    allowed = MAX_QUERIES + (0 if asker == "visitor" else MORE_IF_LOGGED_IN)
    assert 0 < len(asked) <= allowed, "\n\n".join(asked)
