"""What is rendered before anybody asks: of whatever everyone may watch, and the newest first."""

from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path
from typing import NamedTuple

import httpx
import pytest
from sqlalchemy import select
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.hosting.clients import copied_database, serving_filled

from wildscav_engine.specs.map_spec import MapSpec
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.rendering_ahead import RenderingAhead
from wildscav_leaderboard.matches.models import (
    FINISHED,
    LADDER,
    PLAYING,
    SUITE,
    VOID,
    WAITING,
    Match,
    MatchResult,
)
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.spectating.render_cache import RenderCache, Rendering

NOW = datetime.fromisoformat("2030-01-01T00:00:00+00:00")


class Orders(RenderCache):
    """Renders nothing, and notes what is ordered."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self.busy = False
        self.ordered: list[tuple[str, int, bool]] = []  # product, match, and whether of its map alone

    def progress(self, product: str, key: str, source: Path | MapSpec, now: datetime) -> Rendering:
        self.ordered.append((product, int(key), isinstance(source, MapSpec)))
        return Rendering("waiting")

    def is_rendering(self, product: str, key: str) -> bool:
        return self.busy and (product, int(key)) == self.ordered[-1][:2]


class Season(NamedTuple):
    """A season to change, and the last two matches of its ladder: one game."""

    client: httpx.Client
    ahead: RenderingAhead
    orders: Orders
    database: Database
    first: int
    second: int

    def files(self, looks: int) -> list[tuple[str, int, bool]]:
        """Return what has been ordered after some more looks."""
        for _ in range(looks):
            with self.database.reading() as session:
                self.ahead.begin_next(session)
        return self.orders.ordered

    def put(self, first: str | None, second: str) -> None:
        """Bring the two matches into states."""
        with self.database.writing() as session:
            for number, state in ((self.first, first), (self.second, second)):
                if state is not None:
                    session.get_one(Match, number).state = state


@pytest.fixture
def season(hostile_season: FilledSeason, tmp_path: Path) -> Iterator[Season]:
    with (
        serving_filled(hostile_season, renders=False) as (_, app, client),
        copied_database(app, hostile_season, tmp_path) as copy,
    ):
        database = Database(f"sqlite:///{copy}")
        last = select(Match.id).where(Match.kind == LADDER, Match.state == FINISHED).order_by(Match.id.desc())
        with database.reading() as session:
            second, first = session.scalars(last.limit(2)).all()
        orders = Orders(tmp_path / "rendered")
        ahead = RenderingAhead(hostile_season.season, database, orders)
        yield Season(client, ahead, orders, database, first, second)
        database.close()


def test_one_after_the_other_the_newest_first_and_each_once(season: Season) -> None:
    season.orders.busy = True
    assert season.files(3) == [("trails", season.second, False)]
    season.orders.busy = False
    assert season.files(3) == [
        (product, match, False) for match in (season.second, season.first) for product in ("trails", "poster")
    ]
    everything = season.files(60)
    assert len(everything) == len(set(everything)) < 60


def test_the_map_of_a_live_match_is_made_when_it_begins_but_holds_up_no_others(season: Season) -> None:
    season.put(VOID, PLAYING)
    assert season.files(1) == [("map", season.second, True)]  # without a record of the same game
    season.put(FINISHED, FINISHED)
    assert season.files(1)[-1] == ("trails", season.second, False)
    season.put(None, PLAYING)
    assert season.files(60).count(("map", season.second, True)) == 1


def test_the_map_of_a_game_is_made_while_its_first_match_is_played_which_nobody_may_watch(
    season: Season,
) -> None:
    season.put(PLAYING, WAITING)
    assert season.files(1) == [("map", season.second, True)]
    assert season.first not in {match for _, match, _ in season.files(60)}


@pytest.mark.parametrize(
    ("first", "status"),
    [
        (VOID, 503),  # it may be watched, but nothing is rendered in this test
        (FINISHED, 503),
        (WAITING, 403),  # others play on the same map later
    ],
)
def test_a_live_match_has_a_map_whenever_it_may_be_watched(season: Season, first: str, status: int) -> None:
    season.put(first, PLAYING)
    answer = season.client.get(f"/api/v1/matches/{season.second}/map")
    assert answer.status_code == status, answer.text


def test_nothing_hidden_is_rendered(season: Season) -> None:
    season.put(None, PLAYING)
    with season.database.writing() as session:
        late = select(MatchResult).join(Match, Match.id == MatchResult.match_id).where(Match.kind == LADDER)
        before = session.scalars(late.order_by(MatchResult.at.desc()).offset(5)).first()
        assert before is not None
        season_state.freeze(session, before.at - timedelta(microseconds=1))
        hidden = set(session.scalars(select(Match.id).where(Match.kind == SUITE)))
        hidden |= set(session.scalars(select(MatchResult.match_id).where(MatchResult.at >= before.at)))
    ordered = {match for _, match, _ in season.files(60)}
    assert ordered
    assert not ordered & (hidden | {season.first, season.second})
