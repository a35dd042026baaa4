"""A port that cannot be used is named before anything starts."""

import socket
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav.cli import main
from wildscav.errors import UserError
from wildscav_leaderboard.hosting.ports import check_port


def test_a_free_port_is_found_and_a_port_that_is_taken_refused() -> None:
    assert check_port("127.0.0.1", 0) > 0
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(UserError, match=f"port {port} of 127.0.0.1 cannot be used: .*in use"):
            check_port("127.0.0.1", port)
    assert check_port("127.0.0.1", port) == port


def test_an_address_of_another_machine_is_refused() -> None:
    with pytest.raises(UserError, match=r"port 0 of 192\.0\.2\.1 cannot be used"):
        check_port("192.0.2.1", 0)


def test_a_season_does_not_start_on_a_port_that_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    season = make_season(tmp_path / "season")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        monkeypatch.setattr("sys.argv", ["wildscav", "season", "serve", str(season.folder), f"--port={port}"])
        with pytest.raises(SystemExit) as ended:
            main.main()
    assert ended.value.code == 1
    assert f"port {port} of 127.0.0.1 cannot be used" in capsys.readouterr().err
    assert not (season.folder / "season.db").exists()
