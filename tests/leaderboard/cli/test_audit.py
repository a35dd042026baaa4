"""`wildscav verify` as people run it: its table, its document and its exit code."""

import json
from functools import partial
from pathlib import Path

import pytest
from tests.commands import Run, run_command

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.auditing.report import Check, Report
from wildscav_leaderboard.cli import audit_session


@pytest.fixture
def verify(compiled: None, exported: Path, tmp_path: Path) -> Run:
    """Audit the export."""
    command = partial(run_command, "verify", exported, "--workers", 1)
    return partial(command, WILDSCAV_CACHE_DIR=str(tmp_path / "cache"))


def test_it_says_what_was_checked_and_what_was_not_yet(verify: Run) -> None:
    done = verify()
    assert (done.returncode, done.stderr) == (0, "")
    said = " ".join(done.stdout.split())
    assert "everything that was checked is right" in said
    assert "the secret is not opened yet" in said
    assert "seats of the ladder's games" in said


def test_a_wrong_digit_makes_it_fail_and_is_named_in_text_and_document(exported: Path, verify: Run) -> None:
    path = exported / "boards/battle.json"
    right = path.read_text()
    wins = json.loads(right)["rows"][0]["wins"]
    path.write_text(right.replace(f'"wins": {wins}', '"wins": 99', 1))
    try:
        told, printed = (verify("--download", "none", *more) for more in ((), ("--json",)))
    finally:
        path.write_text(right)
    first = "wildscav: boards/battle.json is not the file that SHA256SUMS names"
    assert (told.returncode, told.stderr.splitlines()[0]) == (1, first)
    assert f"wins is published as 99, must be {wins}" in told.stderr
    document = json.loads(printed.stdout)
    assert (printed.returncode, document["holds"]) == (1, False)
    named = [one for one in document["findings"] if one["field"] == "wins"]
    assert [(one["track"], one["published"], one["expected"]) for one in named] == [("battle", 99, wins)]


def test_where_nothing_could_be_checked_nothing_is_called_right(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    report = Report("Spring", "http://host", ("a", "b"), checks=[Check("records", None)])
    monkeypatch.setattr(audit_session, "_audited", lambda *_: report)
    audit_session.run_audit("http://host", LocalExecutor(1))
    said = capsys.readouterr().out
    assert "nothing could be checked yet" in said
    assert "right" not in said
