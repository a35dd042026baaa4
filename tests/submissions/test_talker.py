"""``talker``, a submission that lets a model play; tests/end_to_end/test_models.py plays matches with it."""

import asyncio
from pathlib import Path

import pytest
from tests.platform.helpers.seats import small_spec

from wildscav_evaluator.matches.play import MatchAssignment, play_match
from wildscav_evaluator.submissions.submission import load_submission

TALKER = Path(__file__).parents[2] / "submissions" / "talker"


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_without_a_model_it_says_what_it_needs(tmp_path: Path) -> None:
    seating = MatchAssignment(small_spec("navigation"), (load_submission(TALKER),), (tmp_path / "log",))

    played = asyncio.run(play_match(seating))

    assert played.seats[0].status == "crashed"
    assert "name one with --model FILE" in (tmp_path / "log").read_text("utf-8")
