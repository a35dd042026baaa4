"""``wildscav season demo`` and ``finalize`` as somebody runs them."""

import re
import signal
import socket
import subprocess
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path
from unittest.mock import MagicMock

import httpx
import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav.cli import main
from wildscav_leaderboard.cli.season import demo
from wildscav_leaderboard.hosting.demo import make
from wildscav_leaderboard.seasons.folder import PUBLISHED

WILDSCAV = str(Path(sys.executable).parent / "wildscav")
LONGEST = 300.0  # s


def command(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    """Run a command of a season in this process, and return its exit code."""
    monkeypatch.setattr("sys.argv", ["wildscav", "season", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main.main()
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_a_port_that_is_taken_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert command(monkeypatch, "demo", "--port", port, "--folder", tmp_path / "demo") == 1
    assert capsys.readouterr().err.startswith(f"wildscav: port {port} of 127.0.0.1 cannot be used: ")
    assert not (tmp_path / "demo").exists()


def test_a_demo_tells_how_far_it_is_and_how_to_take_part(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    states = iter((make.Opening(3, 1, 0, 3), make.Opening(3, 3, 2, 3)))
    monkeypatch.setattr(make, "opening_of", lambda *_: next(states))
    monkeypatch.setattr(demo, "LOOKS", 0.0)
    monkeypatch.setattr(demo, "SILENCE", 0.0)
    season = MagicMock()
    season.settings.web.address = "http://here"
    watch = demo._Watch(season, (make.Login("organizer", "organizer", "key"),), 2, opens=False)
    watch()
    watch()
    said = capsys.readouterr()
    assert "1 of 3 submissions are checked, 0 of 2 matches are played\n" in said.err
    assert "log in as organizer  password key to see what organizers see\n" in said.out
    for line in ("login http://here --register\n", "team create my-team\n", "submit my-agent --wait"):
        assert line in said.out


@pytest.mark.slow
def test_a_season_opens_with_a_board_and_ends_with_ctrl_c(tmp_path: Path) -> None:
    command = [WILDSCAV, "season", "demo", "--no-open", "--matches", "1", "--folder", str(tmp_path / "demo")]
    with subprocess.Popen([*command, "--sandbox", "process"], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        said = process.stdout.readline()
        try:
            address = re.search(r"http://127\.0\.0\.1:\d+", said)
            assert address is not None, said
            with httpx.Client(base_url=address[0], timeout=LONGEST) as client:
                board = client.get("/boards/navigation")
                assert board.status_code == 200
                for name in ("random", "homing", "hunter"):
                    assert f"/teams/{name}" in board.text
                name, password = re.findall(r"log in as (\S+) +password (\S+)", process.stdout.readline())[0]
                token = client.post("/api/v1/tokens", json={"name": name, "password": password})
                assert token.status_code == 201, token.text
        finally:
            process.send_signal(signal.SIGINT)
        process.wait(LONGEST)
    assert (tmp_path / "demo" / "season.toml").is_file()


def test_a_season_that_is_over_is_published(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    closed = datetime.now(UTC) - timedelta(minutes=1)
    season = make_season(tmp_path / "season", current=True, closes=closed)
    published = season.folder / PUBLISHED
    for _ in range(2):  # and again
        assert command(monkeypatch, "finalize", season.folder) == 0
        assert "its boards are final, and its secrets are opened" in capsys.readouterr().out
        assert not (published / "of an earlier time").exists()
        (published / "of an earlier time").touch()
    assert command(monkeypatch, "status", season.folder) == 0
    assert re.search(r"season +over\b", capsys.readouterr().out)
    assert command(monkeypatch, "finalize", season.folder, "--abort") == 1
    assert [one.name for one in season.folder.glob("*published*")] == [PUBLISHED]
    assert (published / "secret.txt").read_bytes() == (season.folder / "secret.txt").read_bytes()
    assert (published / "final-secret.txt").is_file()


def test_a_season_that_is_open_is_not_ended_by_accident(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    season = make_season(tmp_path / "season", current=True)
    assert command(monkeypatch, "finalize", season.folder) == 1
    assert "--now ends it at once" in capsys.readouterr().err
    assert not (season.folder / PUBLISHED).exists()
