"""Who may follow a match of a season while it is played, and until when."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import httpx
import pytest
from sqlalchemy import select
from tests.leaderboard.filled_season import COOKIE, FilledSeason
from tests.leaderboard.hosting.clients import copied_database, serving_filled

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, LADDER, PLAYING, VOID, WAITING, Match
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.spectating import streams
from wildscav_leaderboard.spectating.live import LiveMatches, key_of


class Live(NamedTuple):
    """A season whose last match of a ladder is being played, and the same game's other match."""

    database: Database
    client: httpx.Client
    file: Path
    match: int
    other: int
    organizer: dict[str, str]  # headers

    @property
    def path(self) -> str:
        return f"/api/v1/matches/{self.match}/live"

    def put(self, match: int, state: str) -> None:
        with self.database.writing() as session:
            session.get_one(Match, match).state = state


@pytest.fixture
def live(hostile_season: FilledSeason, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Live]:
    monkeypatch.setattr(streams, "CHECK", 0.05)
    folder = LiveMatches(tmp_path / "live")
    folder.folder.mkdir()
    with (
        serving_filled(hostile_season, renders=False) as (_, app, client),
        copied_database(app, hostile_season, tmp_path) as copy,
    ):
        app.state.streams._live = folder
        database = Database(f"sqlite:///{copy}")
        last = select(Match.id).where(Match.kind == LADDER, Match.state == FINISHED).order_by(Match.id.desc())
        with database.reading() as session:
            match, other = session.scalars(last.limit(2)).all()
        cookie = {"Cookie": f"{COOKIE}={hostile_season.people['organizer'].cookie}"}
        found = Live(database, client, folder.path(key_of(match)), match, other, cookie)
        found.put(match, PLAYING)
        found.file.write_text("the beginning\n")
        yield found
        found.file.unlink(missing_ok=True)
        database.close()


@pytest.mark.parametrize(
    ("state", "other", "why"),
    [
        (PLAYING, FINISHED, ""),
        (PLAYING, VOID, ""),
        (PLAYING, WAITING, "others play the same game later"),
        (WAITING, FINISHED, "the match is not being played"),
        (FINISHED, FINISHED, "the match is not being played"),
    ],
)
def test_a_match_is_followed_while_it_is_played_unless_others_play_the_same_game_later(
    live: Live, state: str, other: str, why: str
) -> None:
    live.put(live.match, state)
    live.put(live.other, other)
    with live.client.stream("GET", live.path) as answer:
        if why:
            answer.read()
            assert (answer.status_code, why in answer.json()["error"]) == (403, True)
        else:
            assert "data: the beginning" in answer.iter_lines()


def test_a_freeze_ends_the_streams_of_all_but_organizers(live: Live) -> None:
    with (
        live.client.stream("GET", live.path) as stranger,
        live.client.stream("GET", live.path, headers=live.organizer) as organizer,
    ):
        seen, kept = stranger.iter_lines(), organizer.iter_lines()
        assert "data: the beginning" in seen
        with live.database.writing() as session:
            season_state.freeze(session, datetime.now(UTC))
        assert [line for line in seen if line.startswith("data: ")] == [
            'data: "the public boards are frozen, so it is hidden until the season is finalized"'
        ]
        with live.file.open("a") as file:
            file.write("some news\n")
        assert "data: some news" in kept
    assert live.client.get(live.path).status_code == 403


def test_the_head_of_a_stream_ends(live: Live) -> None:
    answer = live.client.head(live.path)
    assert (answer.status_code, answer.content) == (200, b"")


def test_the_page_names_the_stream_while_the_match_is_played(live: Live) -> None:
    page = f"/matches/{live.match}"
    assert f'data-live="{live.path}"' in live.client.get(page).text
    live.put(live.match, FINISHED)
    assert "data-live" not in live.client.get(page).text
