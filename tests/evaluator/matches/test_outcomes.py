"""What an agent does is the outcome of its seat; what the platform breaks is played again."""

import asyncio
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import QUITTER, TALKER, Submit

from wildscav_engine.simulation.match import Match, MatchSetupError
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.agents import status_of
from wildscav_evaluator.matches.play import (
    MAX_ATTEMPTS,
    MatchAssignment,
    PlatformFaultError,
    PlayedMatch,
    play_match,
)
from wildscav_evaluator.sandbox import Ending, Launch, Limits, Promise, RunningAgent, SandboxError
from wildscav_evaluator.sandbox.process import ProcessSandbox
from wildscav_evaluator.sandbox.processor_waits import GroupMeter
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

pytestmark = pytest.mark.usefixtures("compiled")

MAP = MapSpec(config=MapConfig(size=40, houses=1), seed=3)
STEPS = 20


@pytest.fixture(autouse=True)
def _no_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_evaluator.matches.play.RETRY_DELAY", 0.0)


def play(*submissions: Submission, tmp_path: Path, **options: object) -> PlayedMatch:
    spec = MatchSpec(
        track="gathering", map=MAP, seats=("submission",) * len(submissions), time_limit=STEPS / 10
    )
    logs = tuple(tmp_path / f"{seat}.log" for seat in range(len(submissions)))
    return asyncio.run(play_match(MatchAssignment(spec, submissions, logs), **options))  # type: ignore[arg-type]


class MatchEnded:
    """An agent that runs as a process, but whose sandbox says something of its own about its end."""

    def __init__(self, agent: RunningAgent, ending: Ending) -> None:
        self._agent, self._ending = agent, ending

    async def ended(self) -> Ending:
        await self._agent.ended()
        return self._ending

    def meter(self) -> GroupMeter | None:
        return self._agent.meter()

    def overdue(self) -> str:
        return self._agent.overdue()

    async def stop(self) -> None:
        await self._agent.stop()


class Failing:
    """The process sandbox, which fails in a chosen way at its first starts."""

    name = "failing"
    isolated = False
    runs_images = False

    def promises(self, limits: Limits) -> tuple[Promise, ...]:
        return ()

    def __init__(self, *failures: Exception | Ending) -> None:
        self._failures, self.starts = list(failures), 0

    async def start(self, launch: Launch) -> RunningAgent:
        self.starts += 1
        failure = self._failures.pop(0) if self._failures else None
        if isinstance(failure, Exception):
            raise failure
        agent = await ProcessSandbox().start(launch)
        return MatchEnded(agent, failure) if failure is not None else agent


@pytest.mark.parametrize(
    ("ending", "status"),
    [
        (Ending(exit_code=0), "crashed"),  # before the match was over
        (Ending(killed_by="SIGSEGV"), "crashed"),
        (Ending(exit_code=137, out_of_memory=True), "out_of_memory"),
        (Ending(exit_code=137, limit="wall clock"), "disqualified"),
        (Ending(), "crashed"),
    ],
)
def test_the_end_of_a_process_is_an_outcome(ending: Ending, status: str) -> None:
    assert status_of(ending) == status
    assert status_of(ending).fault == "agent"


@pytest.mark.parametrize("status", SeatStatus)
def test_whatever_a_seat_does_but_finishing_is_its_agents_fault(status: SeatStatus) -> None:
    assert status.fault == (None if status == "finished" else "agent")


def test_an_agent_that_ends_early_has_crashed_with_its_exit_code_and_last_lines(
    submit: Submit, tmp_path: Path
) -> None:
    played = play(submit("crasher", QUITTER), submit("walker", TALKER), tmp_path=tmp_path)

    crasher, walker = played.seats[0], played.seats[1]
    assert (crasher.status, crasher.exit_code, crasher.last_lines) == ("crashed", 7, ("going",))
    assert crasher.detail == "the agent's process ended (exit code 7): going"
    assert (walker.status, walker.exit_code, walker.last_lines) == ("finished", None, ())
    assert walker.steps_played == STEPS


@pytest.mark.slow
def test_an_agent_that_does_not_take_its_seat_in_time_never_joined(submit: Submit, tmp_path: Path) -> None:
    late = submit("late", "    def __init__(self): time.sleep(600)")

    played = play(late, tmp_path=tmp_path, clock=Clock(join_timeout=2.0))

    assert played.seats[0].status == SeatStatus.NEVER_JOINED
    assert played.seats[0].steps_played == 0
    assert "its code was at agent.py:6, in __init__" in played.seats[0].detail


CRASHES_FIRST = """
    def act(self, observation):
        print("step", observation.step)
        if observation.step == 3 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os._exit(1)
        return Action()
"""


@pytest.mark.parametrize(
    ("failure", "body"),
    [
        (BlockingIOError(11, "Resource temporarily unavailable"), TALKER),
        (SandboxError("podman create takes more than 120 s"), TALKER),
        (Ending(exit_code=125, platform_fault="the container could not be started"), CRASHES_FIRST),
    ],
    ids=["no process", "slow sandbox", "broken sandbox"],
)
def test_what_the_platform_breaks_is_played_again_from_the_start(
    submit: Submit, tmp_path: Path, failure: Exception | Ending, body: str
) -> None:
    sandbox = Failing(failure)

    played = play(submit("unlucky", body), tmp_path=tmp_path, sandbox=sandbox)

    assert sandbox.starts == 2
    assert (played.seats[0].status, played.seats[0].steps_played) == ("finished", STEPS)
    assert len(played.platform_faults) == 1
    assert played.match.step_number == STEPS
    assert (tmp_path / "0.log").read_text().count("step 0\n") == 1  # nothing of the first try is left


def test_a_platform_that_fails_again_and_again_gives_the_match_up(submit: Submit, tmp_path: Path) -> None:
    sandbox = Failing(*[BlockingIOError(11, "Resource temporarily unavailable")] * 5)

    with pytest.raises(PlatformFaultError, match=r"failed 3 times: Resource temporarily unavailable$"):
        play(submit("walker", TALKER), tmp_path=tmp_path, sandbox=sandbox)

    assert sandbox.starts == MAX_ATTEMPTS


def test_a_match_that_cannot_be_set_up_is_not_tried_again(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tries = 0

    def refuse(*_: object) -> Match:
        nonlocal tries
        tries += 1
        raise MatchSetupError("there is no room on this map")

    monkeypatch.setattr("wildscav_server.match_server._set_up", refuse)

    with pytest.raises(MatchSetupError):
        play(submit("walker", TALKER), tmp_path=tmp_path)

    assert tries == 1
