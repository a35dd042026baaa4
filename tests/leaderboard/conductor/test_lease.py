"""At any time one process at most is the conductor, whatever clocks say."""

import signal
import time
from collections.abc import Iterator
from datetime import datetime, timedelta, tzinfo
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import NOON, make_season, opened

from wildscav_leaderboard.conductor import lease
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.conductor.lease import Holding, LeaseKeeper, LeaseLostError
from wildscav_leaderboard.database.connection import Database

SECOND = timedelta(seconds=1)


@pytest.fixture
def sqlite(tmp_path: Path) -> Iterator[Database]:
    with opened(make_season(tmp_path / "season")) as database:
        yield database


def acquire(database: Database, holder: str, after: float) -> Holding | None:
    with database.writing() as session:
        return lease.acquire(session, holder, NOON + after * SECOND)


def held(database: Database, after: float = 0) -> Holding:
    holding = acquire(database, "first", after)
    assert holding is not None
    return holding


@pytest.mark.parametrize(
    ("after", "epoch"),
    [
        (0, None),  # somebody holds it
        (29, None),
        (30, 2),  # it was not renewed for 30 s
        (-29, None),  # a clock that is a little late
        (-31, 2),  # nobody can have renewed it for a moment so far ahead: that clock was wrong
    ],
)
def test_who_gets_the_lease(database: Database, after: float, epoch: int | None) -> None:
    assert acquire(database, "first", 0) == Holding("first", 1)
    expected = None if epoch is None else Holding("second", epoch)
    assert acquire(database, "second", after) == expected


class FastClock(datetime):
    """The clock of a host that is a minute ahead."""

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> datetime:
        return datetime.now(tz) + timedelta(minutes=1)


def test_a_host_whose_clock_is_ahead_takes_no_lease_that_is_held(
    database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if database.kind == "sqlite":
        pytest.skip("a file of SQLite is used by one host")
    season = make_season(tmp_path / "season", current=True)
    first, second = Conductor(season, database), Conductor(season, database)
    assert first._acquire()

    for module in ("conductor.conductor", "database.connection"):
        monkeypatch.setattr(f"wildscav_leaderboard.{module}.datetime", FastClock, raising=False)
    assert not second._acquire()
    first._release()
    assert second._acquire()


def test_a_lease_that_is_renewed_lasts_and_one_that_is_given_back_is_free(sqlite: Database) -> None:
    first = held(sqlite)
    with sqlite.writing() as session:
        lease.renew(session, first, NOON + 20 * SECOND)
    assert acquire(sqlite, "second", 49) is None
    with sqlite.writing() as session:
        assert lease.holder_of(session, NOON + 49 * SECOND) == "first"
        lease.release(session, first, NOON + 49 * SECOND)
        assert lease.holder_of(session, NOON + 49 * SECOND) is None
    assert acquire(sqlite, "second", 49) == Holding("second", 2)


def test_whoever_lost_the_lease_can_change_nothing(sqlite: Database) -> None:
    first = held(sqlite)
    acquire(sqlite, "second", 31)
    for act in (lease.renew, lease.release):
        with pytest.raises(LeaseLostError, match="another process"), sqlite.writing() as session:
            act(session, first, NOON + 32 * SECOND)
    # The same process again is another holder: what it began before is lost.
    with pytest.raises(LeaseLostError), sqlite.writing() as session:
        lease.check(session, Holding("second", 1))


def test_nobody_conducts_a_new_season(sqlite: Database) -> None:
    with sqlite.reading() as session:
        assert lease.holder_of(session, NOON) is None
    with pytest.raises(LeaseLostError), sqlite.writing() as session:
        lease.check(session, Holding("nobody", 0))


def test_no_two_processes_have_one_name() -> None:
    assert lease.new_holder() != lease.new_holder()


def work_until_it_is_lost(database: Database, holding: Holding) -> None:
    with LeaseKeeper(database, holding, every=0.01):
        acquire(database, "second", 86_400 * 10_000)  # by a clock that is far ahead of whatever was renewed
        time.sleep(60)
        pytest.fail("nothing interrupted the work")


def test_the_keeper_interrupts_the_work_when_the_lease_is_lost(sqlite: Database) -> None:
    first = held(sqlite)
    before = signal.getsignal(signal.SIGUSR1)
    ignored = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as in the process of a season's conductor
    try:
        with pytest.raises(LeaseLostError):
            work_until_it_is_lost(sqlite, first)
    finally:
        signal.signal(signal.SIGINT, ignored)
    assert signal.getsignal(signal.SIGUSR1) == before


def test_the_keeper_renews_the_lease_and_leaves_no_handler(sqlite: Database) -> None:
    first = held(sqlite, -86_400 * 10_000)
    with sqlite.reading() as session:
        begun = lease.check(session, first).until
    before = signal.getsignal(signal.SIGUSR1)
    with LeaseKeeper(sqlite, first, every=0.01):
        for _ in range(500):
            with sqlite.reading() as session:
                if lease.check(session, first).until != begun:
                    break
            time.sleep(0.01)
        else:
            pytest.fail("the lease was never renewed")
    assert signal.getsignal(signal.SIGUSR1) == before
