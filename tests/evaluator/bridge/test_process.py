"""Matches of agents that play by words or keys, in every sandbox: they have no way to the match itself."""

import asyncio
import os
import signal
import sys
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from benchmarks.strength.words import READER
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox.available import missing

from wildscav.notes import read_notes
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.bridge import process
from wildscav_evaluator.bridge.process import BridgeError
from wildscav_evaluator.matches.play import MatchAssignment, PlayedMatch, play_match
from wildscav_evaluator.sandbox import SANDBOXES, Launch
from wildscav_evaluator.sandbox.processes import all_processes, read_file
from wildscav_evaluator.submissions.submission import Submission, load_submission
from wildscav_server.hosting.hosted_match import HostedMatch, MatchCancelledError

pytestmark = [pytest.mark.usefixtures("compiled"), pytest.mark.slow]
SMALL = MapSpec(config=MapConfig(size=50, houses=1, vegetation=0.2), seed=3)
SPEC = MatchSpec(track="navigation", map=SMALL, seed=2, time_limit=30.0, clock="paused")
WORDS, KEYS = '\ninterface = "words"\n', '\ninterface = "keys"\n[sensors.screen]\nquality = "fast"\n'
# Looks for the match, and for anything that knows more than the texts.
SPY = """
import os, stat
from wildscav import Agent
from wildscav.sdk import connection
from wildscav.sdk.run import play
from wildscav.words import WordsPlayer

class Player(WordsPlayer):
    def play(self, seat):
        tops = ("/run", "/tmp", "/dev") if os.path.exists("/submission") else ()  # else nothing is hidden
        places = (os.path.join(*found) for top in tops
                  for folder, _, files in os.walk(top) for found in [(folder, file) for file in files])
        print("sockets", [place for place in places if stat.S_ISSOCK(os.lstat(place).st_mode)])
        connection.CONNECT_TIMEOUT = 0.5
        own = os.environ["WILDSCAV_ADDRESS"]
        for address in (own, own.replace("bridge.sock", "match.sock")):
            try:
                play(Agent(), address, os.environ["WILDSCAV_TOKEN"])
                print("is in")
            except Exception as error:
                print("no way in:", type(error).__name__)
        try:
            import wildscav_language
            print("imported")
        except ImportError as error:
            print(error)
        print("known", seat.match.start, seat.match.target)
        while not seat.is_over:
            seat.call("look_around")
"""
# Turns until the mark of the compass is ahead, and walks.
PRESSER = """
from wildscav.keyboard import KeysPlayer
from wildscav.policy.keys import Keys

class Player(KeysPlayer):
    def act(self, frame):
        _, columns = (frame.pixels[9:18] == (0xFF, 0xCC, 0x33)).all(axis=2).nonzero()
        away = (columns.mean() - 79.0) * 130.0 / 80.0
        return Keys(forward=abs(away) < 30.0, mouse_x=50.0 * away)
"""


def played(submission: Submission, sandbox: str, tmp_path: Path, spec: MatchSpec = SPEC) -> PlayedMatch:
    if sandbox != "process" and missing(sandbox):
        pytest.skip(missing(sandbox))
    seating = MatchAssignment(spec, (submission,), (tmp_path / "log",))
    return asyncio.run(play_match(seating, sandbox=SANDBOXES[sandbox]))


def success_of(match: PlayedMatch) -> float:
    assert match.seats[0].status == "finished", match.seats[0]
    return match.match.result().seats[0].metrics["success"]


def test_the_reader_reaches_the_target_by_words_alone_and_its_calls_are_notes(tmp_path: Path) -> None:
    match = played(load_submission(READER), "process", tmp_path)

    assert success_of(match) == 1.0
    notes = [note.text for note in read_notes((tmp_path / "log").read_text().splitlines(), 0)]
    assert notes[0].startswith('→ go {"place": "target"')
    assert notes[-1] == "The match is over."


@pytest.mark.parametrize("sandbox", ["bubblewrap", "oci"])
def test_keys_lead_to_the_target(submit: Submit, sandbox: str, tmp_path: Path) -> None:
    open_map = MapSpec(config=MapConfig(size=50, houses=0, vegetation=0.0), seed=3)
    spec = SPEC.model_copy(update={"map": open_map})

    assert success_of(played(submit("presser", code=PRESSER, more=KEYS), sandbox, tmp_path, spec)) == 1.0


@pytest.mark.parametrize("sandbox", ["process", "bubblewrap", "oci"])
def test_an_agent_finds_neither_the_match_nor_what_the_texts_leave_out(
    submit: Submit, sandbox: str, tmp_path: Path
) -> None:
    spec = SPEC.model_copy(update={"time_limit": 2.0})

    assert success_of(played(submit("spy", code=SPY, more=WORDS), sandbox, tmp_path, spec)) == 0.0
    said = (tmp_path / "log").read_text()
    assert "is in" not in said
    assert said.count("no way in:") == 2
    assert "known (nan, nan, nan) None" in said
    if sandbox != "process":  # which hides no files
        assert "sockets ['/run/wildscav/match.sock']" in said
        assert "No module named 'wildscav_language'" in said


def test_a_bridge_that_dies_is_the_platforms_fault_and_the_match_is_played_again(tmp_path: Path) -> None:
    hosted: list[HostedMatch] = []

    async def end_bridge(match: HostedMatch) -> None:
        while match.match.step_number == 0:  # noqa: ASYNC110
            await asyncio.sleep(0.005)
        for number in all_processes():
            is_bridge = b"wildscav_evaluator.bridge" in read_file(number, "cmdline")
            if is_bridge and f" {os.getpid()} ".encode() in read_file(number, "stat"):
                os.kill(number, signal.SIGKILL)

    def begin(match: HostedMatch) -> None:
        hosted.append(match)
        if len(hosted) == 1:
            match.ending = asyncio.create_task(end_bridge(match))  # type: ignore[attr-defined]

    seating = MatchAssignment(SPEC, (load_submission(READER),), (tmp_path / "log",))
    match = asyncio.run(play_match(seating, on_start=begin))

    assert success_of(match) == 1.0
    assert match.platform_faults == ("the bridge to seats of words and keys failed: it ended with code -9",)


@pytest.mark.parametrize(
    ("code", "in_match", "raised"),
    [
        ("import time; time.sleep(60)", None, None),  # slow to end: it is killed, which is no fault
        ("exit(3)", None, BridgeError),
        ("exit(3)", MatchCancelledError(), BridgeError),  # the match was cancelled for it
        ("exit(3)", asyncio.CancelledError(), asyncio.CancelledError),
    ],
)
def test_the_end_of_a_bridge_is_a_fault_only_if_it_fails_by_itself(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    code: str,
    in_match: BaseException | None,
    raised: type[BaseException] | None,
) -> None:
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", code))
    monkeypatch.setattr(process, "END_TIME", 10.0 if raised else 0.1)
    hosted: Any = SimpleNamespace(names=["Ann"], cancel=lambda: None)
    address = f"unix:{tmp_path / 'match.sock'}"
    launch = Launch(tmp_path, "agent:A", address, "token", tmp_path / "log", interface="words")

    async def whole() -> None:
        async with process.bridged({0: launch}, hosted):
            if in_match is not None:
                raise in_match

    with nullcontext() if raised is None else pytest.raises(raised):
        asyncio.run(whole())
