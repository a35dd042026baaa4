"""Results made by hand, and databases of seasons."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest
from tests.leaderboard.filled_season import HOSTILE, FilledSeason, fill_season
from tests.leaderboard.postgresql import PostgreSQL, missing, postgresql_server

from wildscav_evaluator.output.results import (
    Evaluation,
    KeptLimits,
    MatchRow,
    MetricInfo,
    Results,
    Summary,
    Timings,
    Versions,
)
from wildscav_leaderboard.database.connection import Database

VERSIONS = Versions(engine="0.1.0", simulation=2, generator=3, record=2)
METRICS = {
    "navigation": MetricInfo(name="time", title="used + punish time", unit="s", lower_is_better=True),
    "gathering": MetricInfo(name="supplies", title="supplies", unit="", lower_is_better=False),
}


@pytest.fixture
def make_results() -> Callable[..., Results]:
    """Make results: for every (submission, track), the score of each match."""

    def make(
        scores: dict[tuple[str, str], Sequence[float]],
        *,
        version: str = "1.0.0",
        seed: int = 0,
        started: str = "2030-01-01T00:00:00+00:00",
        sandbox: str = "process",
        memory: int | None = None,
        versions: Versions = VERSIONS,
        key: str | None = None,
    ) -> Results:
        evaluations = tuple(
            evaluation(name, track, values, version) for (name, track), values in scores.items()
        )
        timings = Timings(started=started, wall=1.0, jobs=1, matches=())
        return Results(
            versions=versions,
            suite="quick",
            seed=seed,
            sandbox=sandbox,
            limits={track: KeptLimits(memory=memory) for _, track in scores},
            key=key,
            evaluations=evaluations,
            timings=timings,
        )

    return make


def evaluation(name: str, track: str, values: Sequence[float], version: str) -> Evaluation:
    metric = METRICS[track]
    rows = tuple(
        MatchRow(index=index, status="finished", metrics={metric.name: value})
        for index, value in enumerate(values)
    )
    failed = MatchRow(index=0, status="failed", fault="platform", detail="no map")
    mean = sum(values) / len(values) if values else 0.0
    summary = {metric.name: Summary(mean=mean, std=None, low=mean, high=mean)} if values else {}
    return Evaluation(
        submission=name,
        version=version,
        digest=f"digest of {name} {version}",
        track=track,
        metrics=(metric,),
        matches=rows or (failed,),
        summary=summary,
    )


@pytest.fixture(scope="session")
def postgresql() -> Iterator[PostgreSQL]:
    """A PostgreSQL server."""
    if why := missing():
        pytest.skip(why)
    with postgresql_server() as server:
        yield server


@pytest.fixture(params=["sqlite", "postgresql"])
def empty_url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database of each kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'season.db'}"
    server: PostgreSQL = request.getfixturevalue("postgresql")
    return server.new_database()


@pytest.fixture
def database(empty_url: str) -> Iterator[Database]:
    """A season's database of each kind, with all tables."""
    opened = Database(empty_url)
    opened.upgrade()
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def hostile_season(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FilledSeason]:
    """A season whose people and agents write texts that would take over a page, if they could."""
    folder = tmp_path_factory.mktemp("hostile")
    record = folder / "match.wsr"
    record.write_bytes(b"no record that could be rendered")
    filled = fill_season(folder, words=HOSTILE, record=record)
    yield filled
    filled.database.close()
