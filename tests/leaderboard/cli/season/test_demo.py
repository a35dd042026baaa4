"""``wildscav season demo`` as somebody runs it who has never seen a season."""

import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from wildscav.cli import main

WILDSCAV = str(Path(sys.executable).parent / "wildscav")
LONGEST = 300.0  # s


def test_a_port_that_is_taken_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        command = ["wildscav", "season", "demo", "--port", str(port), "--folder", str(tmp_path / "demo")]
        monkeypatch.setattr("sys.argv", command)
        with pytest.raises(SystemExit) as ended:
            main.main()
    assert ended.value.code == 1
    assert capsys.readouterr().err.startswith(f"wildscav: port {port} of 127.0.0.1 cannot be used: ")
    assert not (tmp_path / "demo").exists()


@pytest.mark.slow
def test_a_season_opens_with_a_board_and_ends_with_ctrl_c(tmp_path: Path) -> None:
    command = [WILDSCAV, "season", "demo", "--no-open", "--matches", "4", "--folder", str(tmp_path / "demo")]
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
