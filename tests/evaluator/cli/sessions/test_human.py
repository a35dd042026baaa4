"""``wildscav human --suite``: a person's matches are an evaluation like that of any agent."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.results_by_hand import MODEL, scored_results
from tests.platform.stage.playing.pages import PageClient, page
from tests.platform.stage.playing.tables import table

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.human import person_in_suite
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.output.results import CURRENT_VERSIONS, read_results
from wildscav_evaluator.scores.leaderboard import standings
from wildscav_stage.playing.plan import Plan

SUITE = """
name = "short"
[map]
size = 60
houses = 1
[tracks.navigation]
maps = 1
match = { time_limit = 0.6, clock = "paused" }
[tracks.gathering]
maps = 1
shuffle = false
match = { time_limit = 0.6, clock = "paused", seats = ["submission", "gatherer-easy"] }
"""


@pytest.fixture
def suite(tmp_path: Path) -> str:
    (tmp_path / "short.toml").write_text(SUITE)
    return str(tmp_path / "short.toml")


async def play_matches(first: Plan, folder: Path, count: int) -> list[PageClient]:
    async with table(first, folder) as link, page(link) as person:
        for _ in range(count):
            await person.send(kind="start")
            await person.send(kind="input", number=1, forward=1.0)
            await person.until("over")
        return [person]


def test_a_persons_matches_are_those_of_the_suite_go_on_after_an_end_and_verify(
    suite: str, tmp_path: Path
) -> None:
    out, pages = tmp_path / "ann", []
    for matches in (1, 1):  # the command is ended after the first one
        with person_in_suite("ann", suite, 7, None, out, fresh=False) as first:
            assert first is not None
            pages += asyncio.run(play_matches(first, out / "records", matches))

    results = read_results(out / "results.json")
    told = [json.loads(text) for each in pages for text in each.texts]
    assert [(one.submission, one.track, len(one.matches)) for one in results.evaluations] == [
        ("ann", "navigation", 1),
        ("ann", "gathering", 1),
    ]
    assert {seat.status for one in results.evaluations for row in one.matches for seat in row.seats} == {
        "finished"
    }
    assert [message["next"] for message in told if message["kind"] == "over"] == [
        "Play gathering, match 2 of 2",
        "",
    ]
    run_rescore(out, LocalExecutor(1))  # raises if anything disagrees
    with person_in_suite("ann", suite, 7, None, out, fresh=False) as first:
        assert first is None, "all matches were played"


def test_what_people_cannot_play_is_refused(tmp_path: Path, suite: str) -> None:
    with (
        pytest.raises(UserError, match="people play matches whose first seat alone is a submission's"),
        person_in_suite("ann", "quick", 0, "battle", tmp_path / "out", fresh=False),
    ):
        pass
    hurried = tmp_path / "hurried.toml"
    for clock in ('clock = "running"', 'clock = "paused", thinking = { budget = 60.0 }'):
        hurried.write_text(SUITE.replace('clock = "paused"', clock).replace("short", "hurried"))
        with (
            pytest.raises(UserError, match="people can pause their matches, and those of navigation in"),
            person_in_suite("ann", str(hurried), 0, None, tmp_path / "out", fresh=False),
        ):
            pass
    with (
        pytest.raises(UserError, match="suite short has no track royale"),
        person_in_suite("ann", suite, 0, "royale", tmp_path / "out", fresh=False),
    ):
        pass


@pytest.mark.parametrize(
    ("changed", "tables"),
    [
        ({}, [[(1, "a"), (2, "ann")]]),  # beside agents that played the same matches
        ({"name": "a"}, [[(1, "a"), (2, "a")]]),  # a person replaces no agent
        ({"seed": 9}, [[(1, "a")], [(1, "ann")]]),
        ({"versions": CURRENT_VERSIONS.model_copy(update={"simulation": 99})}, [[(1, "a")], [(1, "ann")]]),
    ],
    ids=["same", "name", "seed", "simulation"],
)
def test_a_person_stands_beside_the_agents_that_played_the_same_matches(
    changed: dict[str, Any], tables: list[list[tuple[int, str]]]
) -> None:
    agents = scored_results({("a", "gathering"): [9.0]}, sandbox="bubblewrap", memory=2**30, model=MODEL)
    name = changed.pop("name", "ann")
    person = scored_results({(name, "gathering"): [5.0]}, sandbox="browser", **changed)
    found = [
        [(row.rank, row.evaluation.submission) for row in one.rows] for one in standings([agents, person])
    ]
    assert sorted(found, key=str) == tables
