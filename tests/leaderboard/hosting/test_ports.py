"""A port that cannot be used is named before anything starts."""

import re
import socket
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav.cli import main
from wildscav.errors import UserError
from wildscav.system.ports import check_port, is_listening

Serve = Callable[..., tuple[object, str]]


@pytest.fixture
def serve(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Serve:
    """Run the command, which is to be refused; return its exit code and its error."""

    def run(folder: Path, *options: str) -> tuple[object, str]:
        monkeypatch.setattr("sys.argv", ["wildscav", "season", "serve", str(folder), *options])
        with pytest.raises(SystemExit) as ended:
            main.main()
        return ended.value.code, " ".join(capsys.readouterr().err.split())

    return run


def test_a_port_that_is_taken_or_of_another_machine_is_refused() -> None:
    assert check_port("127.0.0.1", 0) > 0
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert is_listening("127.0.0.1", port)
        with pytest.raises(
            UserError, match=f"port {port} of 127.0.0.1 cannot be used: .*in use; choose another with --port"
        ):
            check_port("127.0.0.1", port)
    assert check_port("127.0.0.1", port) == port
    assert not is_listening("127.0.0.1", port)
    with pytest.raises(UserError, match=r"port 0 of 192\.0\.2\.1 cannot be used"):
        check_port("192.0.2.1", 0)


@pytest.mark.parametrize(
    ("written", "said"),
    [
        (None, "cert.pem and .*key.pem cannot be used for TLS: No such file or directory"),
        ("no certificate", "cert.pem and .*key.pem cannot be used for TLS: .*PEM"),
    ],
)
def test_a_season_does_not_start_without_its_certificate(
    tmp_path: Path, serve: Serve, written: str | None, said: str
) -> None:
    folder = make_season(tmp_path / "season", '[web]\ncertificate = "cert.pem"\nkey = "key.pem"').folder
    for name in ("cert.pem", "key.pem") if written else ():
        (folder / name).write_text(written or "")
    code, error = serve(folder)
    assert code == 2
    assert re.search(said, error)


def test_an_option_that_would_be_ignored_is_refused(tmp_path: Path, serve: Serve) -> None:
    code, error = serve(make_season(tmp_path / "season").folder, "--conductor", "--metrics-port=0")
    assert code == 2
    assert "belong to the web site, not --conductor" in error


def test_a_season_does_not_start_on_a_port_that_is_taken(tmp_path: Path, serve: Serve) -> None:
    season = make_season(tmp_path / "season")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        code, error = serve(season.folder, f"--port={port}")
    assert code == 1
    assert f"port {port} of 127.0.0.1 cannot be used" in error
    assert not (season.folder / "season.db").exists()
