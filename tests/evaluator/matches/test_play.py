"""One match with real agents: whatever one of them does, the others and the match are not harmed."""

import asyncio
import os
import threading
from pathlib import Path

import pytest
from tests.evaluator.conftest import submission_in
from tests.evaluator.sample_agents import SLEEPER, WALKER, Submit
from tests.evaluator.small_matches import need, play, seated

from wildscav_evaluator.matches.play import MatchAssignment, PlayedMatch, play_match
from wildscav_evaluator.sandbox.process import kill_session
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

pytestmark = pytest.mark.usefixtures("compiled")

STEPS = 60
THINKER = """
    def think(self):
        time.sleep(600)

    def act(self, observation):
        if observation.step == 3:
            self.think()
        return Action()
"""


def battle(*submissions: Submission, tmp_path: Path) -> MatchAssignment:
    return seated(*submissions, folder=tmp_path, track="battle", seconds=STEPS / 10, robots=("fighter",))


def test_two_submissions_and_a_robot_play_to_the_end(submit: Submit, tmp_path: Path) -> None:
    seating = battle(submit("first", WALKER), submit("second", WALKER), tmp_path=tmp_path)

    played = play(seating)

    assert played.match.over
    assert seating.names == ("first", "second", "fighter 1")
    assert {seat: report.status for seat, report in played.seats.items()} == {0: "finished", 1: "finished"}
    assert [report.steps_played for report in played.seats.values()] == [STEPS, STEPS]


# Agents that fail, each with what is said of its end.
FAILING = {
    "unborn": ("    def __init__(self): raise ValueError('no reason')", "ValueError: no reason"),
    "resetless": ("    def reset(self, match): raise ValueError('no reason')", "ValueError: no reason"),
    "crasher": ("    def act(self, observation): return 1 / 0", "ZeroDivisionError"),
    "speechless": (
        "    def act(self, observation): pass",
        "Player.act() must return an Action, such as Action(",
    ),
    "locating": (
        "    def act(self, observation): raise ValueError('no reason')",
        "ValueError: no reason (agent.py:6, in act)",
    ),
    "verbose": (
        "    def act(self, observation): raise ValueError('no reason\\nat all\\n  whatever')",
        "ValueError: no reason",
    ),
    "parent": (  # its child holds its output open
        """
    def act(self, observation):
        subprocess.Popen(["sleep", "3"], start_new_session=True)
        raise ValueError("no reason")
""",
        "ValueError: no reason",
    ),
    "quitter": ("    def act(self, observation): os._exit(0)", "exit code 0"),
    "killed": (
        """
    def act(self, observation):
        if observation.step == 20:
            print("going", flush=True)
            os.kill(os.getpid(), 9)
        return Action()
""",
        "killed by SIGKILL): going",
    ),
}


@pytest.fixture(scope="module")
def among_failing(tmp_path_factory: pytest.TempPathFactory) -> PlayedMatch:
    """A match of one that walks with all that fail."""
    place = tmp_path_factory.mktemp("failing")
    agents = [submission_in(place, name, body) for name, (body, _) in FAILING.items()]
    walker = submission_in(place, "walker", WALKER)
    return play(seated(*agents, walker, folder=place, track="battle", seconds=STEPS / 10))


@pytest.mark.parametrize(("seat", "name"), list(enumerate(FAILING)))
def test_an_agent_that_fails_is_named_with_its_last_words(
    among_failing: PlayedMatch, seat: int, name: str
) -> None:
    report = among_failing.seats[seat]

    assert report.status == SeatStatus.CRASHED
    assert FAILING[name][1] in report.detail
    assert "\n" not in report.detail


def test_an_agent_that_is_killed_is_reported_with_its_signal_and_steps(among_failing: PlayedMatch) -> None:
    killed = among_failing.seats[list(FAILING).index("killed")]

    assert (killed.killed_by, killed.last_lines, killed.steps_played) == ("SIGKILL", ("going",), 20)


def test_those_that_fail_cost_another_no_step(among_failing: PlayedMatch) -> None:
    walker = among_failing.seats[len(FAILING)]

    assert (walker.status, walker.steps_played) == (SeatStatus.FINISHED, STEPS)


@pytest.mark.slow
def test_an_agent_that_thinks_for_ever_uses_up_its_own_time_alone(submit: Submit, tmp_path: Path) -> None:
    thinker = submit("thinker", THINKER)
    seating = battle(thinker, submit("other", WALKER), tmp_path=tmp_path)

    played = play(seating, clock=Clock(step_budget=0.1, time_bank=0.2))

    assert played.seats[0].status == SeatStatus.TIMED_OUT
    assert "step 3 was the first without its answer" in played.seats[0].detail
    assert "its code was at agent.py:8, in think, called from agent.py:12, in act" in played.seats[0].detail
    assert played.seats[1].status == SeatStatus.FINISHED


def test_a_match_that_is_cancelled_leaves_no_agent_behind(submit: Submit, tmp_path: Path) -> None:
    sleeper = submit("sleeper", SLEEPER)
    seating = battle(sleeper, tmp_path=tmp_path)

    async def break_off() -> int:
        playing = asyncio.create_task(play_match(seating))
        while not (seating.logs[0].exists() and seating.logs[0].read_text().strip()):  # noqa: ASYNC110
            await asyncio.sleep(0.05)
        playing.cancel()
        with pytest.raises(asyncio.CancelledError):
            await playing
        return int(seating.logs[0].read_text())

    pid = asyncio.run(break_off())

    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
    kill_session(pid, None)  # has nobody to kill, and does not mind


@pytest.mark.parametrize("sandbox", ["process", pytest.param("oci", marks=pytest.mark.slow)])
def test_no_list_of_processes_is_read_where_agents_are_timed(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sandbox: str
) -> None:
    need(sandbox)  # which may read the list itself
    readers: list[threading.Thread] = []
    listdir = os.listdir

    def record(path: str = ".") -> list[str]:
        if path == "/proc":
            readers.append(threading.current_thread())
        return listdir(path)

    monkeypatch.setattr(os, "listdir", record)

    played = play(battle(submit("walker", WALKER), tmp_path=tmp_path), sandbox)

    assert played.seats[0].status == "finished"
    assert readers
    assert threading.current_thread() not in readers


def test_a_long_temporary_folder_is_no_obstacle_to_a_unix_socket(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    deep = tmp_path / ("d" * 100)
    deep.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(deep))

    assert play(battle(submit("walker", WALKER), tmp_path=tmp_path)).seats[0].status == "finished"
