"""What an agent does is the outcome of its seat; whatever of ours fails is played again, and blamed on none.

Each failure is real: at some call, a part of the server or the engine raises, as if it had a mistake. The
agents are processes, which see their streams end as they would then.
"""

import pkgutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator import small_matches
from tests.evaluator.sample_agents import QUITTER, TALKER, Submit

from wildscav.errors import UserError
from wildscav_engine.simulation.match import Match, MatchSetupError
from wildscav_evaluator.matches.agents import status_of
from wildscav_evaluator.matches.play import (
    MAX_ATTEMPTS,
    PlatformFaultError,
    PlayedMatch,
)
from wildscav_evaluator.sandbox import Ending, Launch, SandboxError
from wildscav_evaluator.sandbox.agents.agent_process import AgentProcess
from wildscav_evaluator.sandbox.process import ProcessSandbox
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

pytestmark = pytest.mark.usefixtures("compiled")
STEPS = 10
MISTAKE = "a mistake of ours"
SENSOR = "\n[sensors.depth]\nwidth = 4\nheight = 4\n"
# What fails, and at which call of it. With two seats most things are called twice a step.
OFTEN = [
    ("wildscav_engine.simulation.match:Match.step", 5),
    ("wildscav_server.hosting.lockstep:encode_observation", 5),
    ("wildscav_server.hosting.lockstep:decode_action", 5),
    ("wildscav_server.endpoints.match_service:_read_join", 1),
]
ALL = [
    *OFTEN,
    *(
        pytest.param(*seam, marks=pytest.mark.slow)
        for seam in (
            ("wildscav_engine.simulation.match:Match.start_info", 1),  # for the first message to a seat
            ("wildscav_engine.simulation.match:Match.start_info", 2),
            ("wildscav_engine.simulation.match:Match.result", 1),  # for the last one
            ("wildscav_server.hosting.seat:Seat.read_sensors", 5),
            ("wildscav_server.hosting.observations:SeatObservations.encode", 5),
            ("wildscav_server.endpoints.match_service:MatchService._find_reservation", 2),
            ("wildscav_server.hosting.hosted_match:HostedMatch.join", 2),
            ("wildscav_server.hosting.hosted_match:HostedMatch.ready", 1),
            ("wildscav_server.hosting.hosted_match:HostedMatch.next_observation", 3),
            ("wildscav_server.hosting.hosted_match:encode_match_info", 1),
            ("wildscav_server.hosting.hosted_match:encode_seat_result", 2),
            ("wildscav_server.hosting.seat:Seat.conduct_message", 1),
            ("wildscav_server.time_limits:TimeBank.charge", 3),
        )
    ),
]


@pytest.fixture(autouse=True)
def _no_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_evaluator.matches.play.RETRY_DELAY", 0.0)


def break_at(monkeypatch: pytest.MonkeyPatch, where: str, call: int) -> None:
    """Have a function or method raise at its so-manieth call, and only then."""
    works: Callable[..., Any] = pkgutil.resolve_name(where)
    calls = 0

    def breaks(*arguments: Any, **named: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == call:
            raise RuntimeError(MISTAKE)
        return works(*arguments, **named)

    owner, _, name = where.replace(":", ".").rpartition(".")
    monkeypatch.setattr(pkgutil.resolve_name(owner), name, breaks)


def play(*submissions: Submission, tmp_path: Path, **options: Any) -> PlayedMatch:
    return small_matches.play(small_matches.seated(*submissions, folder=tmp_path), **options)


def check_played_again(played: PlayedMatch) -> None:
    """The match was broken once, then played from its start to its end by all."""
    assert played.platform_faults == (f"RuntimeError: {MISTAKE}",)
    assert {(seat.status, seat.steps_played) for seat in played.seats.values()} == {("finished", STEPS)}
    assert played.match.step_number == STEPS


@pytest.mark.parametrize(("where", "call"), ALL)
def test_whatever_fails_at_the_server_is_the_platforms_fault(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str, call: int
) -> None:
    first, second = submit("first", TALKER, more=SENSOR), submit("second", TALKER)
    break_at(monkeypatch, where, call)

    check_played_again(play(first, second, tmp_path=tmp_path))


def test_a_clock_that_fails_while_nobody_answers_does_not_wait_for_ever(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sleepy = """
    def act(self, observation):
        if observation.step == 3 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            time.sleep(600)
        return Action()
"""
    break_at(monkeypatch, "wildscav_server.time_limits:TimeBank.charge", 4)

    played = play(submit("sleepy", sleepy), tmp_path=tmp_path, clock=Clock(step_budget=0.1, time_bank=0.0))

    check_played_again(played)


CRASHES_FIRST = """
    def act(self, observation):
        print("step", observation.step)
        if observation.step == 3 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os._exit(1)
        return Action()
"""


class Flawed(ProcessSandbox):
    """The process sandbox, which fails in chosen ways at its first starts: at once, or when an agent ends."""

    def __init__(self, *failures: Exception | Callable[[], Ending]) -> None:
        self._failures, self.starts = list(failures), 0

    async def start(self, launch: Launch) -> AgentProcess:
        self.starts += 1
        failure = self._failures.pop(0) if self._failures else None
        if isinstance(failure, Exception):
            raise failure
        agent = await super().start(launch)
        if failure is not None:
            ended = agent.ended

            async def otherwise() -> Ending:
                await ended()
                return failure()

            agent.ended = otherwise  # type: ignore[method-assign]
        return agent


def lose_sight() -> Ending:
    raise OSError(5, "Input/output error")


def test_what_a_sandbox_never_runs_is_not_tried_again(submit: Submit, tmp_path: Path) -> None:
    faults: list[str] = []
    submission = replace(submit("walker", TALKER), image="of/somebody")

    with pytest.raises(UserError, match="image of/somebody needs --sandbox oci"):
        play(submission, tmp_path=tmp_path, on_failure=faults.append)
    assert faults == []


def test_what_a_sandbox_takes_to_start_is_nobodys_time_to_join(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An agent's time begins when its match hears that it was launched."""
    happened: list[str] = []
    launched = HostedMatch.launched

    class Told(ProcessSandbox):
        async def start(self, launch: Launch) -> AgentProcess:
            agent = await super().start(launch)
            happened.append("started")
            return agent

    def hear(hosted: HostedMatch, seat: int) -> None:
        happened.append(f"launched {seat}")
        launched(hosted, seat)

    monkeypatch.setattr(HostedMatch, "launched", hear)

    played = play(*(submit(name, TALKER) for name in ("first", "second")), tmp_path=tmp_path, sandbox=Told())

    assert happened == ["started", "launched 0", "started", "launched 1"]
    assert [seat.status for seat in played.seats.values()] == ["finished", "finished"]
    assert all(seat.start_up is not None for seat in played.seats.values())


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


@pytest.mark.parametrize(
    ("failure", "body", "fault"),
    [
        (BlockingIOError(11, "Resource temporarily unavailable"), TALKER, "Resource temporarily unavailable"),
        (SandboxError("podman create takes more than 120 s"), TALKER, "podman create takes more than 120 s"),
        (lambda: Ending(exit_code=125, platform_fault="it did not start"), CRASHES_FIRST, "it did not start"),
        (lose_sight, CRASHES_FIRST, "Input/output error"),
    ],
    ids=["no process", "slow sandbox", "broken sandbox", "unknown end"],
)
def test_what_the_platform_breaks_is_played_again_from_the_start(
    submit: Submit, tmp_path: Path, failure: Exception | Callable[[], Ending], body: str, fault: str
) -> None:
    sandbox = Flawed(failure)

    played = play(submit("unlucky", body), tmp_path=tmp_path, sandbox=sandbox)

    assert sandbox.starts == 2
    assert (played.seats[0].status, played.seats[0].steps_played) == ("finished", STEPS)
    assert played.platform_faults == (fault,)
    assert played.match.step_number == STEPS
    assert (tmp_path / "0.log").read_text().count("step 0\n") == 1  # nothing of the first try is left


def test_a_platform_that_fails_again_and_again_gives_the_match_up(submit: Submit, tmp_path: Path) -> None:
    sandbox = Flawed(*[BlockingIOError(11, "Resource temporarily unavailable")] * 5)

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
