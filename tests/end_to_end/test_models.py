"""A scripted model plays all tracks in real sandboxes by ``talker``; its server misbehaves at first."""

import asyncio
import json
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.end_to_end.pages import ROOT
from tests.evaluator.sandbox.available import missing
from tests.scripted_mind import mind
from tests.scripted_model import (
    NO_CHOICES,
    Answer,
    Call,
    Endless,
    Failed,
    Late,
    Messages,
    Raw,
    Reset,
    Said,
    ScriptedModel,
    called,
    cut,
    disturbed,
    said,
    too_many,
)

from wildscav.notes import read_notes
from wildscav_engine.record import read_record, verify_record, write_record
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.play import MatchAssignment, play_match
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.submissions.submission import load_submission

pytestmark = pytest.mark.slow
TALKER = ROOT / "submissions" / "talker"
OTHERS = {
    "navigation": (),
    "gathering": ("gatherer-easy",),
    "capture": ("seeker-easy",),
    "battle": ("fighter-easy", "fighter-easy"),
    "royale": ("fighter-easy", "fighter-easy"),
}
DISTURBANCES: list[Answer] = [
    Failed(500),
    said("Where am I?"),
    Reset(),
    cut("go"),
    too_many(0.1),
    called("fly", up=1),
    Endless(),
    Endless(pause=0.05),
    Late(60.0),
    NO_CHOICES,
    Said(calls=(Call("go", '{"bearing": 0, "seconds": 1}'), Call("note", '{"text": "I went north."}'))),
    Raw(b"<html>Bad gateway</html>", 502),
]
ARENA = """
name = "arena"
map = { size = 60, houses = 1 }

[tracks.battle]
maps = 1
match = { time_limit = 10, clock = "paused" }
"""


def aloud(messages: Messages, tools: list[dict[str, object]]) -> Said:
    answer = mind(messages, tools)
    return Said(f"I call {answer.calls[0].name}.", answer.calls)


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize(
    ("track", "sandbox"), [*((track, "bubblewrap") for track in OTHERS), ("navigation", "oci")]
)
def test_a_model_plays(track: str, sandbox: str, tmp_path: Path) -> None:
    if why := missing(sandbox):
        pytest.skip(why)
    small = MapSpec(config=MapConfig(size=60, houses=1), seed=3)
    seats = ("submission", *OTHERS[track])
    spec = MatchSpec(track=track, map=small, seed=1, seats=seats, time_limit=20.0, clock="paused")

    disturbances = DISTURBANCES if track == "navigation" else []  # which cost time, in which matches wait
    with ScriptedModel(disturbed(aloud, dict(enumerate(disturbances)))) as model:
        asked = ModelSettings(url=model.url, name="scripted", timeout=1.0, retries=10)
        seating = MatchAssignment(spec, (load_submission(TALKER),), (tmp_path / "log",), model=asked)
        played = asyncio.run(play_match(seating, sandbox=SANDBOXES[sandbox]))

    assert played.seats[0].status == "finished", played.seats[0]
    assert len(model.requests) > len(disturbances)
    notes = [note.text for note in read_notes((tmp_path / "log").read_text("utf-8").splitlines(), 0)]
    last = model.requests[-1].body
    answer = aloud(last["messages"], last["tools"])
    ((tool, arguments),) = answer.calls
    assert notes[-3:] == [answer.text, f"→ {tool} {arguments}", "The match is over."]
    write_record(tmp_path / "match.wsr", played.match, seating.names)
    assert verify_record(read_record(tmp_path / "match.wsr")).holds


@pytest.mark.usefixtures("compiled")
def test_a_model_is_rated_against_a_baseline_and_robots_and_its_records_hold(tmp_path: Path) -> None:
    (tmp_path / "arena.toml").write_text(ARENA, "utf-8")

    with ScriptedModel(aloud) as model:
        (tmp_path / "model.toml").write_text(f'url = "{model.url}"\nname = "scripted"\n', "utf-8")
        entrants = (TALKER, "hunter", "robot:fighter")
        options = ("--track", "battle", "--suite", "arena.toml", "--rounds", "1", "--replays", "none")
        rest = ("--model", "model.toml", "--sandbox", "process", "--out", "out")
        done = run_command("tournament", *entrants, *options, *rest, cwd=tmp_path)

    assert done.returncode == 0, done.stderr
    standings = json.loads((tmp_path / "out" / "tournament.json").read_text("utf-8"))
    assert "talker" in str(standings)
    assert list((tmp_path / "out" / "exchanges").iterdir())
    verified = run_command("verify", "out", cwd=tmp_path)
    assert verified.returncode == 0, verified.stderr
