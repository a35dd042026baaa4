"""Results of a season: its pages, its boards, and one more result."""

import tempfile
import time
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.report import children_of, free_port, processor_time
from benchmarks.services.large_season import Size, make_large_season
from benchmarks.services.service import ask, served, wait_for
from sqlalchemy import delete, select, update
from tests.leaderboard.results_made import made_result

from wildscav_evaluator.output.results import metric_infos
from wildscav_leaderboard.boards.service import apply_results, compute, store
from wildscav_leaderboard.boards.suite_scores import SuiteScores
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, WAITING, Match, MatchResult, MatchSeat
from wildscav_leaderboard.matches.service import deliver
from wildscav_leaderboard.seasons.folder import Season

# A hundred results of each submission; the last with ten times as many.
SIZES = {
    1_000: Size(10, 90, 100),
    10_000: Size(100, 90, 1_000),
    100_000: Size(1_000, 90, 10_000),
    1_000_000: Size(1_000, 90, 10_000, copies=10),
}
PAGES = {"board_page": "/boards/navigation", "board_api": "/api/v1/boards/navigation"}
RATE, SECONDS = 20.0, 4.0  # requests a second, and for how long
MORE = 4  # results that are added one by one, on the ladder and in the suite


def results(count: int) -> dict[str, float]:
    """Measure a season in SQLite that has some results."""
    with tempfile.TemporaryDirectory() as folder:
        size = SIZES[count]
        season = make_large_season(Path(folder) / "season", free_port(), size)
        found = _adding(season, size)
        return found | _pages(season, PAGES | {"match_page": f"/matches/{size.matches - 1}"})


def _adding(season: Season, size: Size) -> dict[str, float]:
    """Measure the boards of everything, and some results as if they arrived one by one."""
    database, scores = season.database(), SuiteScores()
    end = {"ladder": size.matches * size.copies, "suite": size.submissions * size.suite_matches}
    last = {kind: range(number - MORE + 1, number + 1) for kind, number in end.items()}
    with database.writing() as session:
        reopened = [*last["ladder"], *last["suite"]]
        session.execute(delete(MatchResult).where(MatchResult.match_id.in_(reopened)))
        session.execute(update(Match).where(Match.id.in_(reopened)).values(state=WAITING))
    found = {"boards_of_everything": _refreshed(database, season, scores)[0]}
    stored = []
    for kind, numbers in last.items():
        boards = []
        for match in numbers:
            started = time.perf_counter()
            _deliver(database, match)
            stored.append(time.perf_counter() - started)
            boards.append(_refreshed(database, season, scores))
        computing, writing = zip(*boards, strict=True)
        found |= {f"boards_of_{kind}": min(computing), f"writing_of_{kind}": min(writing)}
    database.close()
    return found | {"stored": min(stored)}


def _refreshed(database: Database, season: Season, scores: SuiteScores) -> tuple[float, float]:
    """Bring the boards up to date as a conductor does; return the processor time, s, and the writer's."""
    times, is_applied = [time.process_time()], False
    while not is_applied:
        with database.writing() as session:
            is_applied = not apply_results(session, season)
    times.append(time.process_time())
    with database.reading() as session:
        computed = compute(session, season, datetime.now(UTC), scores)
    times.append(time.process_time())
    with database.writing() as session:
        store(session, season, computed)
    times.append(time.process_time())
    return times[3] - times[0], times[1] - times[0] + times[3] - times[2]


def _deliver(database: Database, number: int) -> None:
    """Store the result of a match, in a transaction of its own."""
    with database.writing() as session:
        match = session.get_one(Match, number)
        seats = session.scalars(select(MatchSeat).filter_by(match_id=number)).all()
        row, timing, record = made_result(match, seats, [30.0 + seat.seat for seat in seats])
        metric = metric_infos(match.track)[0]
        deliver(session, match, None, row, timing, record, metric, datetime.now(UTC))
        if match.state != FINISHED:
            raise RuntimeError(f"match {number} has no result")


def _pages(season: Season, pages: dict[str, str]) -> dict[str, float]:
    """Measure the server's processor time for each page, s."""
    port, found = season.settings.web.port, {}
    with served(season, "web") as web:
        wait_for(f"http://127.0.0.1:{port}/ready")
        (server,) = children_of(web.pid)
        for name, path in pages.items():
            ask(port, path, seconds=1.0, connections=1, rate=None)  # first come caches
            before = processor_time(server)
            load = ask(port, path, seconds=SECONDS, connections=2, rate=RATE)
            if load.failures:
                raise RuntimeError(f"{path} was not answered")
            found[name] = (processor_time(server) - before) / len(load.latencies)
    return found
