"""What people play at a table of a season."""

import asyncio
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import ASKER
from tests.leaderboard.agents import write_agent
from tests.leaderboard.filled_season import FilledSeason
from tests.scripted_model import ScriptedModel, in_turn, said

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.sandbox import SANDBOXES, Limits
from wildscav_evaluator.submissions.submission import Submission, load_submission
from wildscav_leaderboard.playing.host import LOG, SandboxedAgents, plan_of
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


def play(submission: Submission, folder: Path, seconds: float, model: ModelSettings | None = None) -> str:
    """Play a match with a submission as a table does; return how it ended for it."""
    small = MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.0), seed=1)
    spec = MatchSpec(track="navigation", map=small, seed=1, time_limit=seconds)

    async def outcome() -> MatchOutcome:
        server = MatchServer()
        (address,) = await server.start([f"unix:{folder / 'match.sock'}"])
        hosted = await server.host(spec, names=["it"], sensors={0: submission.sensors})
        agents = SandboxedAgents(submission, SANDBOXES["process"], Limits(), model)
        async with agents({0: submission.folder}, hosted, {0: address}, folder):
            outcome = await hosted.finished()
        await server.stop()
        return outcome

    return asyncio.run(outcome()).seats[0].status


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_who_plays_by_words_can_be_played_against(tmp_path: Path) -> None:
    reader = load_submission(HUNTER.parents[1] / "benchmarks" / "strength" / "reader")

    assert play(reader, tmp_path, seconds=20.0) == "finished"


@pytest.mark.usefixtures("compiled")
def test_who_asks_a_model_can_be_played_against(tmp_path: Path) -> None:
    asker = load_submission(write_agent(tmp_path, "asker", ASKER))

    with ScriptedModel(in_turn(said("go on"))) as model:
        settings = ModelSettings(url=model.url, name="tiny")
        assert play(asker, tmp_path, seconds=1.0, model=settings) == "finished"

    assert (tmp_path / LOG).read_text().count("go on") == len(model.requests) > 0


def test_guests_have_seats_before_the_submission_and_the_robots(hostile_season: FilledSeason) -> None:
    plan = plan_of(order(hostile_season, "royale"), load_submission(HUNTER), Play(people=3, match=60.0))
    assert plan.spec.seats == ("submission",) * 4 + ("fighter-easy",) * 4
    assert (plan.names[0], plan.names[3]) == ("person 1", "night-owl")
    assert plan.submissions == (3,)
    assert plan.spec.time_limit == 60.0
