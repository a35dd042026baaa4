"""Evaluate, edit, evaluate again: the loop of everybody who writes an agent."""

import json
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Command, Submit

SUITE = """
name = "tiny"
[map]
size = 40
houses = 1
[tracks.navigation]
maps = 7
episodes = 1
match = { time_limit = 2 }
"""


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_an_edited_agent_is_evaluated_beside_its_former_self(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    folder = submit("mine", WALKER).folder
    (tmp_path / "tiny.toml").write_text(SUITE)
    arguments = ("evaluate", folder, "--suite=tiny.toml", "--replays=none")

    first = wildscav(*arguments, cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    assert "since last time" not in first.stdout

    manifest = folder / "submission.toml"
    manifest.write_text(manifest.read_text().replace("1.0.0", "2.0.0"))
    (folder / "agent.py").write_text((folder / "agent.py").read_text().replace("6.0", "0.0"))
    second = wildscav(*arguments, cwd=tmp_path)
    assert second.returncode == 0, second.stderr
    assert "since last time" in second.stdout
    assert "0001 1.0.0" in " ".join(second.stdout.split())

    again = wildscav(*arguments, "--json", cwd=tmp_path)
    assert again.returncode == 0
    assert "all 7 matches were played before" in again.stderr
    document = json.loads(again.stdout)
    assert document["folder"] == "out/evaluations/0002-mine"
    assert document["results"]["evaluations"][0]["version"] == "2.0.0"
    (since,) = document["since_last"]
    assert (since["folder"], since["version"], since["comparison"]["pairs"]) == ("0001-mine", "1.0.0", 7)

    fresh = wildscav(*arguments, "--fresh", cwd=tmp_path)
    assert fresh.returncode == 0
    assert "played before" not in fresh.stdout
    kept = sorted(path.name for path in (tmp_path / "out" / "evaluations").iterdir())
    assert kept == ["0001-mine", "0002-mine", "0003-mine"]
