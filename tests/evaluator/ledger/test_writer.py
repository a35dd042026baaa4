"""Keeping a ledger over several sittings, each of which may be killed at any moment."""

from pathlib import Path

import pytest
from tests.evaluator.interrupted_runs import Sitting
from tests.evaluator.results_by_hand import identity_of

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.entries import MatchStarted, Resumed
from wildscav_evaluator.ledger.keys import SigningKey, new_key
from wildscav_evaluator.ledger.ledger import LedgerError, read_ledger
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.output.identity import Identity
from wildscav_evaluator.output.layout import LEDGER_FILE

SUITE = """
name = "short"
map = { size = 40, houses = 0 }
[tracks.navigation]
maps = 4
match = { time_limit = 2.0 }
"""


@pytest.fixture
def key(tmp_path: Path) -> SigningKey:
    return new_key(tmp_path / "season.key")


@pytest.fixture
def identity(key: SigningKey) -> Identity:
    return identity_of("ada", key=key.public)


def test_a_ledger_goes_on_where_a_killed_one_ended(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    path = tmp_path / LEDGER_FILE
    first = LedgerWriter(tmp_path, identity, key)
    first.begin("navigation-000-ada")
    whole = path.read_bytes()
    path.write_bytes(whole + b'{"at":"2030-01-01T00:00')  # killed while it wrote the next entry

    second = LedgerWriter(tmp_path, identity, key)
    second.begin("navigation-000-ada")

    assert path.read_bytes().startswith(whole)
    ledger = read_ledger(tmp_path)
    assert ledger is not None
    assert [type(entry.fact) for entry in ledger.entries[1:]] == [MatchStarted, Resumed, MatchStarted]
    assert ledger.head == second.head
    assert ledger.interrupted == {"navigation-000-ada": 1}, "a try that was interrupted does not vanish"


def test_a_match_that_the_platform_broke_was_not_interrupted(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    keeper = LedgerWriter(tmp_path, identity, key)
    for _ in range(2):
        keeper.begin("navigation-000-ada")
        keeper.broke("navigation-000-ada", "the worker process died (SIGKILL)")

    ledger = read_ledger(tmp_path)

    assert ledger is not None
    assert ledger.interrupted == {}
    assert len(ledger.entries) == 5


def test_a_ledger_killed_in_its_first_line_begins_again(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    (tmp_path / LEDGER_FILE).write_bytes(b'{"at":')

    LedgerWriter(tmp_path, identity, key)

    ledger = read_ledger(tmp_path)
    assert ledger is not None
    assert ledger.identity == identity


def test_no_text_in_a_ledger_can_steer_a_terminal(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    reason = "no \x1b[31m memory \u202e left \x7f, für 😀"
    LedgerWriter(tmp_path, identity, key).broke("navigation-000-ada", reason)

    line = (tmp_path / LEDGER_FILE).read_bytes().splitlines()[-1]

    assert line.isascii()
    assert line.decode().isprintable()
    ledger = read_ledger(tmp_path)
    assert ledger is not None
    assert getattr(ledger.entries[-1].fact, "reason", "") == reason


def test_nothing_goes_on_in_a_ledger_that_was_changed(
    tmp_path: Path, identity: Identity, key: SigningKey
) -> None:
    keeper = LedgerWriter(tmp_path, identity, key)
    for number in range(3):
        keeper.begin(f"navigation-00{number}-ada")
    path = tmp_path / LEDGER_FILE
    lines = path.read_bytes().splitlines(keepends=True)

    path.write_bytes(b"".join([*lines[:1], *lines[2:]]))
    with pytest.raises(UserError, match=r"line 2: does not follow the previous line.*--fresh"):
        LedgerWriter(tmp_path, identity, key)
    with pytest.raises(LedgerError, match="line 2: does not follow"):
        read_ledger(tmp_path)

    path.write_bytes(b"".join(lines))
    with pytest.raises(UserError, match="is of another evaluation"):
        LedgerWriter(tmp_path, identity.model_copy(update={"seed": "7"}), key)


def ended(out: Path) -> int:
    """How many matches the ledger of a running evaluation has."""
    path = out / LEDGER_FILE
    return path.read_bytes().count(b'"kind":"ended"') if path.exists() else 0


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_a_signed_evaluation_that_was_killed_comes_to_a_whole_ledger(
    pair: tuple[Path, Path], tmp_path: Path, key: SigningKey, capsys: pytest.CaptureFixture[str]
) -> None:
    out, suite = tmp_path / "out", tmp_path / "short.toml"
    suite.write_text(SUITE)
    arguments = (*pair, f"--suite={suite}", "--replays=none", "--workers=2", "--sandbox=process")
    signed = (*arguments, f"--sign={tmp_path / 'season.key'}")

    for least in (1, 4):
        Sitting(out, *signed).kill_when(lambda least=least: ended(out) >= least)  # type: ignore[misc]
    assert Sitting(out, *arguments).process.wait() == 2, "it went on without its key"
    Sitting(out, *signed).process.wait()

    ledger = read_ledger(out)
    assert ledger is not None
    assert sum(isinstance(entry.fact, Resumed) for entry in ledger.entries) == 2
    assert len(ledger.played) == 8
    run_rescore(out, LocalExecutor(1), key.public)
    assert "8 records played again: all agree" in capsys.readouterr().out
