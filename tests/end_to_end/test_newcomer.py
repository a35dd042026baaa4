"""What a newcomer does: make an agent, play it, evaluate it, see where it stands. Nothing in between."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.commands import run_command

BIN = Path(sys.executable).parent


def run(folder: Path, *arguments: object, code: int = 0) -> str:
    done = subprocess.run(
        [str(BIN / str(arguments[0])), *map(str, arguments[1:])],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=500,
        env={**os.environ, "COLUMNS": "80"},
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.slow
def test_an_agent_that_fails_in_play_is_named_with_its_last_words(tmp_path: Path) -> None:
    run(tmp_path, "wildscav", "init", "broken")
    agent = tmp_path / "broken" / "agent.py"
    agent.write_text(agent.read_text().replace("self.detour = 0 ", "self.detour = 1 / 0 "))

    said = run(tmp_path, "wildscav", "play", "broken", "--time-limit=2", "--size=60", code=1)

    assert "wildscav: broken" in said
    assert "ZeroDivisionError: division by zero" in said
    assert "out/play/0-broken.log" in said
    log = (tmp_path / "out/play/0-broken.log").read_text()
    assert "agent.py" in log


@pytest.mark.slow
def test_the_demo_ends_with_three_tables_and_records_that_all_hold(tmp_path: Path) -> None:
    submissions = Path(__file__).parents[2] / "submissions"
    folders = [submissions / name for name in ("random", "homing", "hunter")]
    tracks = ("navigation", "gathering", "battle")
    short = "".join(f"[tracks.{track}]\nmaps = 2\nmatch = {{ time_limit = 3 }}\n" for track in tracks)
    (tmp_path / "short.toml").write_text(f'name = "short"\nmap = {{ size = 60, houses = 1 }}\n{short}')

    chosen = ("--suite=short.toml", *(f"--track={track}" for track in tracks))
    done = run_command("evaluate", *folders, "--out=out/demo", *chosen, cwd=tmp_path)

    assert done.returncode == 0, done.stderr
    for track in tracks:
        assert f"{track} · suite short@" in done.stdout
    assert "rerun" in done.stdout
    records = sorted((tmp_path / "out/demo/records").iterdir())
    results = json.loads((tmp_path / "out/demo/results.json").read_text())
    assert len(records) == sum(len(evaluation["matches"]) for evaluation in results["evaluations"])
    assert run_command("verify", *records, cwd=tmp_path).returncode == 0
    replays = sorted((tmp_path / "out/demo/replays").iterdir())
    assert len(replays) == 9
    run(tmp_path, "rerun", "rrd", "verify", *replays)
