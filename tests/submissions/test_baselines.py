"""The baselines: submissions like any other, and each better than the one before at what it is for."""

import ast
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.small_matches import job_of

from wildscav_engine.record import read_record
from wildscav_engine.record.verify import resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.zone import zone_at
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.matches.workers import Workers
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_evaluator.suites.suite import suite

pytestmark = pytest.mark.long
SUBMISSIONS = Path(__file__).parents[2] / "submissions"
NAMES = ("random", "homing", "hunter")
STAYERS = ("homing", "hunter", "survivor")  # in the safe zone
# Of ways: they play navigation alone.
FINDERS = ("navigator", "mapper", "learned-navigator", "cloned-navigator")
TRACKS = ("navigation", "gathering", "capture", "battle", "royale")
FLAT = MapSpec(config=MapConfig(size=100, houses=0, relief=0, water=0, vegetation=0), seed=1)


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    with Workers(1) as pool:
        pool.precompile()
        yield pool


def job(name: str, spec: MatchSpec, out: Path, index: int = 0) -> Job:
    return job_of(load_submission(SUBMISSIONS / name), out, index, spec)


def jobs(name: str, track: str, seed: int, out: Path) -> list[Job]:
    return [job(name, spec, out, index) for index, spec in enumerate(suite(track, "quick", seed))]


def course(played: Job, measure: Callable[[Match], float]) -> list[float]:
    """What is measured after each step of a match."""
    return [measure(match) for match in resimulate(read_record(played.out / played.record))]


def play(workers: Workers, wanted: list[Job]) -> list[JobResult]:
    results = list(workers.run(wanted))
    assert [result.row.detail for result in results if result.row.fault] == []
    return results


def mean(results: list[JobResult], name: str, metric: str) -> float:
    values = [(result.row.metrics or {})[metric] for result in results if result.job.evaluated == name]
    return sum(values) / len(values)


@pytest.mark.parametrize("name", [*NAMES, *FINDERS, "scavenger", "commando", "survivor"])
def test_they_import_the_sdk_and_the_standard_library_alone_or_numpy(name: str) -> None:
    allowed = {"wildscav"} | sys.stdlib_module_names | ({"numpy"} if name in FINDERS else set())
    folder = SUBMISSIONS / name
    own = {path.stem for path in folder.glob("*.py")}
    for path in folder.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            modules = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            modules += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
            for module in modules:
                root = module.partition(".")[0]
                assert root in own | allowed, f"{path}: {module}"
    assert load_submission(folder).name == name
    assert (folder / "README.md").exists()


@pytest.mark.slow
@pytest.mark.parametrize("track", TRACKS)
def test_the_same_match_is_played_the_same_way(workers: Workers, tmp_path: Path, track: str) -> None:
    spec = suite(track, "quick", 0)[0].model_copy(update={"time_limit": 5.0})
    first, second = ([job(name, spec, tmp_path / each) for name in NAMES] for each in ("first", "second"))

    play(workers, first + second)

    for one, other in zip(first, second, strict=True):
        assert (one.out / one.record).read_bytes() == (other.out / other.record).read_bytes()


@pytest.mark.slow
def test_finders_of_ways_play_the_same_match_the_same_way_in_time(workers: Workers, tmp_path: Path) -> None:
    first = [jobs(name, "navigation", 0, tmp_path / "first")[0] for name in FINDERS]
    second = [jobs(name, "navigation", 0, tmp_path / "second")[0] for name in FINDERS]

    results = play(workers, first + second)

    for one, other in zip(first, second, strict=True):
        assert (one.out / one.record).read_bytes() == (other.out / other.record).read_bytes()
    for name in FINDERS:
        assert mean(results, name, "success") == 1.0


def shrinking(wait: float, shrink: float) -> MatchSpec:
    """A royale without enemies, in which the zone shrinks once, to a circle far from the start."""
    phase = ZonePhase(wait=wait, shrink=shrink, share=0.3, damage=5)
    return MatchSpec(
        track="royale",
        map=FLAT,
        seed=2,
        start=(-20.0, 0.0, -20.0),
        time_limit=18.0,
        zone=ZoneConfig(phases=(phase,)),
    )


def depth(match: Match) -> float:
    """How far inside the safe zone the first seat is, m."""
    zone = zone_at(match.state.matches, 0, match.frame)
    x, _, z = match.state.agents.position[0, 0]
    return float(zone.radius - np.hypot(x - zone.x, z - zone.z))


def health(match: Match) -> float:
    return float(match.state.agents.health[0, 0])


def test_some_are_in_the_next_circle_before_the_zone_has_shrunk(workers: Workers, tmp_path: Path) -> None:
    wanted = [job(name, shrinking(wait=8.0, shrink=4.0), tmp_path) for name in STAYERS]

    play(workers, wanted)

    for played in wanted:
        assert min(course(played, depth)) >= 0.0
        assert course(played, health)[-1] == 100


def test_some_walk_into_a_zone_that_they_are_outside_of(workers: Workers, tmp_path: Path) -> None:
    wanted = [job(name, shrinking(wait=0.0, shrink=0.02), tmp_path) for name in STAYERS]

    play(workers, wanted)

    for played in wanted:
        depths = course(played, depth)[1:]
        assert depths[0] < -10.0
        arrival = next(step for step, deep in enumerate(depths) if deep >= 0.0)
        assert min(depths[arrival:]) >= 0.0
        assert 0 < course(played, health)[-1] < 100


@pytest.mark.parametrize("target", [45.0, -5.0])
def test_homing_and_hunter_find_a_hidden_target_and_go_there(
    workers: Workers, tmp_path: Path, target: float
) -> None:
    spec = MatchSpec(
        track="capture",
        map=FLAT,
        start=(-45.0, 0.0, -45.0),
        target=(target, 0.0, target),
        time_limit=60.0,
    )
    wanted = [job(name, spec, tmp_path) for name in ("homing", "hunter")]

    results = play(workers, wanted)

    for name in ("homing", "hunter"):
        assert mean(results, name, "success") == 1.0


def test_teammates_divide_the_search_among_themselves(workers: Workers, tmp_path: Path) -> None:
    spec = MatchSpec(
        track="capture",
        map=MapSpec(config=FLAT.config.model_copy(update={"size": 200}), seed=1),
        seats=(SUBMISSION,) * 3,
        starts=((-2.0, 0.0, 0.0), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0)),
        target=(95.0, 0.0, 95.0),
        time_limit=20.0,
    )
    team = job("homing", spec, tmp_path)

    play(workers, [team])

    middles = np.arange(-95.0, 100.0, 10.0)
    grid = np.stack(np.meshgrid(middles, middles), axis=-1)
    seen = np.zeros((3, *grid.shape[:2]), bool)  # by each seat
    for match in resimulate(read_record(team.out / team.record)):
        offsets = grid - match.state.agents.position[0, :3, [0, 2]].T[:, None, None]
        seen |= np.linalg.norm(offsets, axis=-1) < 15.0
    assert np.sum(seen.sum(axis=0) > 1) < 0.2 * np.sum(seen.any(axis=0))


@pytest.mark.slow
def test_homing_reaches_most_targets_and_random_few(workers: Workers, tmp_path: Path) -> None:
    wanted = [job for name in ("random", "homing") for job in jobs(name, "navigation", 0, tmp_path)]

    results = play(workers, wanted)

    assert mean(results, "homing", "success") >= 0.8
    assert mean(results, "homing", "time") < mean(results, "random", "time") / 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("track", "seeds", "worse", "better", "metric", "factor"),
    [
        ("gathering", [0], "random", "homing", "supplies", 2.0),
        ("battle", [1], "homing", "hunter", "kills", 1.0),
        ("royale", [0, 1, 2], "random", "hunter", "points", 1.0),
    ],
)
def test_each_is_better_than_the_one_before_at_what_it_is_for(
    workers: Workers,
    tmp_path: Path,
    track: str,
    seeds: list[int],
    worse: str,
    better: str,
    metric: str,
    factor: float,
) -> None:
    wanted = [job for name in (worse, better) for seed in seeds for job in jobs(name, track, seed, tmp_path)]

    results = play(workers, wanted)

    assert mean(results, better, metric) > factor * mean(results, worse, metric)
    if better == "hunter":
        assert mean(results, "hunter", "kills") > mean(results, worse, "kills")
    if track == "battle":
        assert mean(results, "hunter", "kills") >= 1.0
        assert mean(results, "hunter", "supplies") > 0.0
