"""Whatever is killed at whatever moment: nothing is lost, nothing is done twice, nothing is stuck."""

import random
from pathlib import Path

import pytest
from tests.leaderboard.hosting.killed_season import KilledSeason
from tests.leaderboard.postgresql import PostgreSQL, missing, postgresql_server

pytestmark = [pytest.mark.slow, pytest.mark.long]
SUBMISSIONS = 1


def storm(folder: Path, server: PostgreSQL | None, seed: int, rounds: int) -> None:
    season = KilledSeason(folder, SUBMISSIONS, server, random.Random(seed))  # noqa: S311 (no secret)
    with season.served():
        season.storm(rounds)
        season.check()
    season.database.close()


def test_killing_web_conductor_and_workers(tmp_path: Path) -> None:
    storm(tmp_path, None, seed=1, rounds=1)


@pytest.mark.skipif(bool(missing()), reason=missing())
def test_killing_the_database_too(tmp_path: Path) -> None:
    with postgresql_server() as server:
        storm(tmp_path, server, seed=2, rounds=1)
