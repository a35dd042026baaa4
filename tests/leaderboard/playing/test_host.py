"""What people play at a table of a season."""

import asyncio
from pathlib import Path

import pytest
from tests.leaderboard.filled_season import FilledSeason

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.sandbox import SANDBOXES, Limits
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_leaderboard.playing.host import SandboxedAgents, plan_of
from wildscav_leaderboard.playing.order import SEEDS, Order
from wildscav_leaderboard.playing.tables import OpenTable, Tables, Wish
from wildscav_leaderboard.seasons.settings import Play
from wildscav_server.hosting.reports import MatchOutcome
from wildscav_server.match_server import MatchServer
from wildscav_stage.playing.plan import DEFAULT_MAP

HUNTER = Path(__file__).parents[3] / "submissions" / "hunter"


def order(filled: FilledSeason, track: str) -> Order:
    wish = Wish("me", 1, "night-owl.tar.gz", "night-owl-1", "night-owl", track, "http://localhost")
    return Tables(filled.season)._order(OpenTable(wish), Path("table"))


@pytest.mark.parametrize("track", ["battle", "royale"])
def test_nobody_practises_on_a_map_of_the_season(hostile_season: FilledSeason, track: str) -> None:
    orders = [order(hostile_season, track) for _ in range(50)]
    assert len({one.seed for one in orders}) == 50  # drawn for each table, not from the season's secrets
    for one in orders[:3]:
        assert one.seed < SEEDS  # those of a season are larger, but for one in two thousand
        spec = plan_of(one, load_submission(HUNTER), Play()).spec
        assert (spec.map, spec.seed) == (MapSpec(config=DEFAULT_MAP, seed=one.seed), one.seed)


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_who_plays_by_words_can_be_played_against(tmp_path: Path) -> None:
    reader = load_submission(HUNTER.parents[1] / "benchmarks" / "strength" / "reader")
    small = MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.0), seed=1)
    spec = MatchSpec(track="navigation", map=small, seed=1, time_limit=20.0)

    async def play() -> MatchOutcome:
        server = MatchServer()
        (address,) = await server.start([f"unix:{tmp_path / 'match.sock'}"])
        hosted = await server.host(spec, names=["reader"], sensors={0: reader.sensors})
        agents = SandboxedAgents(reader, SANDBOXES["process"], Limits())
        async with agents({0: reader.folder}, hosted, {0: address}, tmp_path):
            outcome = await hosted.finished()
        await server.stop()
        return outcome

    assert asyncio.run(play()).seats[0].status == "finished"


def test_guests_have_seats_before_the_submission_and_the_robots(hostile_season: FilledSeason) -> None:
    plan = plan_of(order(hostile_season, "royale"), load_submission(HUNTER), Play(people=3, match=60.0))
    assert plan.spec.seats == ("submission",) * 4 + ("fighter-easy",) * 4
    assert (plan.names[0], plan.names[3]) == ("person 1", "night-owl")
    assert plan.submissions == (3,)
    assert plan.spec.time_limit == 60.0
