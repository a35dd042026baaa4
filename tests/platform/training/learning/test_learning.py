"""`wildscav train` learns: the first command of docs/training.md reaches what the page promises."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from wildscav.cli.main import app

pytest.importorskip("torch")
pytest.importorskip("tensorboardX")
pytestmark = pytest.mark.slow  # PyTorch is installed for the slow tests alone

LEARNED = 0.9  # share of targets reached; random actions reach 0.03 of them
LONGEST = 180.0  # s of one processor


def test_the_first_command_of_the_page_learns_to_navigate_in_three_minutes_of_one_core(
    tmp_path: Path,
) -> None:
    done = CliRunner().invoke(app, ["train", "--level", "easy", "--out", str(tmp_path / "easy"), "--json"])

    assert done.exit_code == 0, (done.output, done.exception)
    (result,) = json.loads(done.stdout)["runs"]
    reached = {(score["split"], score["choose"]): score["metrics"]["success"] for score in result["scores"]}
    assert reached["train", "sampled"] >= LEARNED
    assert reached["test", "sampled"] >= LEARNED, "it has learned the maps of training, and not to navigate"
    assert result["cpu_seconds"] <= LONGEST
    figures = (tmp_path / "easy" / "seed-0" / "figures.jsonl").read_text().splitlines()
    successes = [json.loads(line).get("success", 0.0) for line in figures]
    assert successes[-1] >= LEARNED
