"""``talker``, a submission that lets a model play; tests/end_to_end/test_models.py plays matches with it."""

import asyncio
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.platform.helpers.seats import small_spec

from wildscav_evaluator.matches.play import MatchAssignment, play_match
from wildscav_evaluator.submissions.submission import load_submission

TALKER = Path(__file__).parents[2] / "submissions" / "talker"


@pytest.mark.parametrize("command", [["play"], ["check"], ["evaluate"], ["tournament", "--track", "battle"]])
def test_where_there_is_no_model_it_is_refused_before_its_match(command: list[str], tmp_path: Path) -> None:
    others = ["homing"] if command[0] == "tournament" else []

    done = run_command(*command, TALKER, *others, cwd=tmp_path)

    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "wildscav: submission 'talker' asks a language model: add --model FILE, which names its server"
    ]
    assert list(tmp_path.iterdir()) == []


def test_it_is_not_played_against_its_record(tmp_path: Path) -> None:
    done = run_command("verify", TALKER / "agent.py", "--agent", TALKER, cwd=tmp_path)

    assert (done.returncode, done.stderr) == (
        2,
        "wildscav: submission 'talker' asks a language model, and verify offers none\n",
    )


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_without_a_model_it_says_what_it_needs(tmp_path: Path) -> None:
    seating = MatchAssignment(small_spec("navigation"), (load_submission(TALKER),), (tmp_path / "log",))

    played = asyncio.run(play_match(seating))

    assert played.seats[0].status == "crashed"
    assert "name one with --model FILE" in (tmp_path / "log").read_text("utf-8")
