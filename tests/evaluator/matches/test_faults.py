"""Whose fault it is: whatever of ours fails, and wherever, the match is played again, and no agent is blamed.

Each failure is real: at some call, a part of the server or the engine raises, as if it had a mistake. The
agents are processes, which see their streams end as they would then.
"""

import asyncio
import pkgutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.sample_agents import TALKER, Submit

from wildscav.errors import UserError
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.play import MatchAssignment, PlatformFaultError, PlayedMatch, play_match
from wildscav_evaluator.sandbox import SANDBOXES, Launch, RunningAgent
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.hosted_match import HostedMatch
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
    small = MapSpec(config=MapConfig(size=40, houses=0), seed=3)
    seats = ("submission",) * len(submissions)
    spec = MatchSpec(track="gathering", map=small, seats=seats, time_limit=STEPS / 10)
    logs = tuple(tmp_path / f"{seat}.log" for seat in range(len(submissions)))
    return asyncio.run(play_match(MatchAssignment(spec, submissions, logs), **options))


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


class LosesSight:
    """The process sandbox, which cannot tell once how an agent ended."""

    name, isolated, runs_images, lost = "losing sight", False, False, False

    def promises(self, limits: object) -> tuple[()]:
        return ()

    async def start(self, launch: Launch) -> RunningAgent:
        agent = await SANDBOXES["process"].start(launch)
        if not self.lost:
            self.lost = True
            ended = agent.ended

            async def breaks() -> Any:
                await ended()
                raise OSError(5, "Input/output error")

            agent.ended = breaks  # type: ignore[method-assign]
        return agent


def test_an_agent_whose_end_the_sandbox_cannot_tell_is_not_blamed_for_it(
    submit: Submit, tmp_path: Path
) -> None:
    crashes_first = """
    def act(self, observation):
        if observation.step == 3 and not os.path.exists("was_here"):
            open("was_here", "w").close()
            os._exit(1)
        return Action()
"""

    played = play(submit("unlucky", crashes_first), tmp_path=tmp_path, sandbox=LosesSight())

    assert played.platform_faults == ("Input/output error",)
    assert (played.seats[0].status, played.seats[0].steps_played) == ("finished", STEPS)


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

    class Told(LosesSight):
        lost = True

        async def start(self, launch: Launch) -> RunningAgent:
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


def test_a_mistake_that_stays_gives_the_match_up_and_no_agent(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(*_: object) -> None:
        raise RuntimeError(MISTAKE)

    monkeypatch.setattr("wildscav_engine.simulation.match.Match.step", breaks)

    with pytest.raises(PlatformFaultError, match=f"failed 3 times: RuntimeError: {MISTAKE}"):
        play(submit("walker", TALKER), tmp_path=tmp_path)
