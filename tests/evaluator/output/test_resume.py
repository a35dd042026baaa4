"""An evaluation may be killed at any moment: the same command goes on; nothing is lost or played twice."""

import os
import random
import time
from pathlib import Path

import pytest
from tests.evaluator.interrupted_runs import Sitting, check_whole, entered, files, without_timings
from tests.evaluator.small_matches import tiny_suite

from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.output.layout import LEDGER_FILE
from wildscav_evaluator.output.results import read_results

pytestmark = pytest.mark.usefixtures("compiled")

MATCHES = 4  # of both
KILLS = 2  # at random moments; WILDSCAV_TEST_KILLS asks for more


@pytest.fixture
def arguments(pair: tuple[Path, Path], key_file: Path, key: SigningKey, tmp_path: Path) -> tuple[object, ...]:
    """An evaluation that is signed, of short matches: what is looked at is what lies between them."""
    assert key_file.exists()
    suite = tiny_suite(tmp_path, maps=2, seconds=2)
    return *pair, f"--suite={suite}", "--replays=none", "--workers=1", f"--sign={key_file}"


def check_same_as_whole(out: Path, whole: Path) -> None:
    """It came to what an evaluation comes to that nobody killed."""
    assert without_timings(out) == without_timings(whole)
    assert files(out, "records") == files(whole, "records")
    assert files(out, "logs").keys() == files(whole, "logs").keys()
    assert [path.name for path in out.rglob(".*")] == []
    timings = read_results(out / "results.json").timings.matches
    assert len({(one.submission, one.index) for one in timings}) == len(timings) == MATCHES


def entries(out: Path) -> tuple[int, int]:
    """How many entries the ledger has, and how many of them say that the evaluation was resumed."""
    ledger = (out / LEDGER_FILE).read_bytes() if (out / LEDGER_FILE).exists() else b""
    return ledger.count(b"\n"), ledger.count(b'"kind":"resumed"')


@pytest.mark.slow
def test_kills_at_random_moments_lose_nothing(
    arguments: tuple[object, ...], key: SigningKey, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole, most = tmp_path / "whole", int(os.environ.get("WILDSCAV_TEST_KILLS", KILLS))
    sitting = Sitting(whole, *arguments)
    sitting.await_begin()
    started = time.monotonic()
    sitting.process.wait()
    length = time.monotonic() - started  # s; a sitting that goes on is shorter
    dice, kills = random.Random(2), 0  # noqa: S311
    folders = (tmp_path / f"out-{number}" for number in range(1000))
    out, before = next(folders), {}
    while True:
        earlier, resumed = entries(out)
        sitting = Sitting(out, *arguments)
        killed = kills < most and sitting.kill_after(dice.uniform(0.0, 0.7 * length))
        if killed:
            kills += 1
            check_whole(out)
        else:
            sitting.process.wait()
        total, again = entries(out)
        assert again - resumed == (0 < earlier < total), "a sitting that goes on says so, and once"
        now = entered(out)
        assert {stem: now.get(stem) for stem in before} == before, "a match was lost or played again"
        before = now
        if not killed:
            check_same_as_whole(out, whole)
            run_rescore(out, LocalExecutor(1), key.public)
            assert f"{MATCHES} records played again: all agree" in capsys.readouterr().out
            if kills == most:
                break
            out, before = next(folders), {}
