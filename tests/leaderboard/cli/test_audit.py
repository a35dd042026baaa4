"""`wildscav verify` as people run it: its table, its document and its exit code."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav.cli import main
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.folder import Season

Said = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def folder(played: tuple[Season, Database], tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("out") / "export"
    export(*played, out)
    return out


@pytest.fixture
def wildscav(
    compiled: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Said:
    """Run a command in this process; return its exit code, and what it printed."""
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "cache"))

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["wildscav", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main.main()
        printed = capsys.readouterr()
        return int(ended.value.code or 0), printed.out, printed.err

    return run


def test_it_says_what_was_checked_and_what_was_not_yet(folder: Path, wildscav: Said) -> None:
    code, printed, errors = wildscav("verify", folder, "--workers", 1)
    assert (code, errors) == (0, "")
    said = " ".join(printed.split())
    assert "everything that was checked is right" in said
    assert "the secret is not opened yet" in said
    assert "seats of the ladder's games" in said


def test_a_wrong_digit_makes_it_fail_and_is_named_in_text_and_document(folder: Path, wildscav: Said) -> None:
    path = folder / "boards/battle.json"
    right = path.read_text()
    wins = json.loads(right)["rows"][0]["wins"]
    path.write_text(right.replace(f'"wins": {wins}', '"wins": 99', 1))
    try:
        code, _, errors = wildscav("verify", folder, "--workers", 1, "--download", "none")
        assert code == 1
        assert errors.splitlines()[0] == (
            "wildscav: boards/battle.json is not the file that SHA256SUMS names"
        )
        assert f"wins is published as 99, must be {wins}" in errors
        code, printed, _ = wildscav("verify", folder, "--workers", 1, "--download", "none", "--json")
    finally:
        path.write_text(right)
    document = json.loads(printed)
    assert (code, document["holds"]) == (1, False)
    named = [one for one in document["findings"] if one["field"] == "wins"]
    assert [(one["track"], one["published"], one["expected"]) for one in named] == [("battle", 99, wins)]
