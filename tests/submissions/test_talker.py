"""``talker``: a submission that lets a model play by words."""

import asyncio
import shutil
from pathlib import Path

import pytest
from tests.platform.helpers.seats import small_spec
from tests.scripted_mind import mind
from tests.scripted_model import Answer, Messages, ScriptedModel

from wildscav_evaluator.matches.play import MatchAssignment, PlayedMatch, play_match
from wildscav_evaluator.submissions.submission import load_submission

TALKER = Path(__file__).parents[2] / "submissions" / "talker"
ASKING = 'import os\n\nos.environ["WILDSCAV_MODEL"] = {!r}\n\nfrom talker import Talker as Talker\n'


def talk(messages: Messages, tools: list[dict[str, object]]) -> Answer:
    """Think aloud."""
    answer = mind(messages, tools)
    return type(answer)(f"I call {answer.calls[0].name}.", answer.calls)


def play(folder: Path, log: Path) -> PlayedMatch:
    spec = small_spec("navigation", seconds=20.0)
    return asyncio.run(play_match(MatchAssignment(spec, (load_submission(folder),), (log,))))


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_it_plays_what_the_model_says(tmp_path: Path) -> None:
    folder = shutil.copytree(TALKER, tmp_path / "talker")
    (folder / "agent.py").rename(folder / "talker.py")

    with ScriptedModel(talk, path=tmp_path / "model.sock") as model:
        (folder / "agent.py").write_text(ASKING.format(model.url), "utf-8")
        played = play(folder, tmp_path / "log")

    assert played.seats[0].status == "finished"
    assert played.match.result().seats[0].metrics["success"] == 1.0
    assert '{"step": 0, "say": "I call go."}' in (tmp_path / "log").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_without_a_model_it_says_what_it_needs(tmp_path: Path) -> None:
    played = play(TALKER, tmp_path / "log")

    assert played.seats[0].status == "crashed"
    assert "name one with --model FILE" in (tmp_path / "log").read_text("utf-8")
