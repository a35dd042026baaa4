"""The SDK as an agent's author meets it."""

import copy
import dataclasses
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.helpers.seats import Served, connected, ended, small_spec, start_agent, with_server

from wildscav import Action, Agent, Observation, WildscavError
from wildscav.agent import check_action
from wildscav.errors import AgentError, UserError
from wildscav.geometry import direction_to, flat_distance, moved, pitch_to, turn_to
from wildscav.proto.match_pb2 import Observation as ObservationMessage
from wildscav.proto.match_pb2 import Vector
from wildscav.sdk.run import run
from wildscav.wire.observations import decode_observation
from wildscav_server.hosting.reports import SeatStatus


def test_an_action_takes_any_kind_of_number_and_flag() -> None:
    numbers = {"walk_direction": 90, "walk_speed": np.float32(2.5), "turn": np.array(3.0)}
    flags = {"jump": np.bool_(True), "shoot": 1}
    action = Action(**numbers, **flags)  # type: ignore[arg-type]
    assert action == Action(90.0, 2.5, 3.0, 0.0, True, False, True, False)
    assert type(action.walk_direction) is float
    assert type(action.jump) is bool


@pytest.mark.parametrize(
    ("field", "value", "allowed"),
    [
        ("walk_speed", "fast", "a number"),
        ("turn", None, "a number"),
        ("look", [1.0, 2.0], "a number"),
        ("jump", "yes", "True or False"),
        ("shoot", 0.5, "True or False"),
        ("reload", None, "True or False"),
    ],
)
def test_an_action_says_what_is_wrong_with_a_field(field: str, value: object, allowed: str) -> None:
    with pytest.raises(AgentError, match=f"{field} is .* must be {allowed}"):
        Action(**{field: value})  # type: ignore[arg-type]


def observation(**fields: Any) -> Observation:
    """Return an observation that has just arrived."""
    return decode_observation(ObservationMessage(**fields), 50)


def test_an_observation_is_read_as_far_as_it_is_asked_for() -> None:
    asked: list[str] = []
    seen = Observation.read_by(lambda name: asked.append(name) or 7)
    assert (seen.health, seen.step, seen.health) == (7, 7, 7)
    assert asked == ["health", "step"]


def test_an_observation_that_arrived_is_one_like_any_other() -> None:
    seen = observation(step=3, frame=15, health=80, position=Vector(x=1.0))
    assert seen == observation(step=3, frame=15, health=80, position=Vector(x=1.0))
    assert seen != observation(step=3, frame=15, health=81, position=Vector(x=1.0))
    assert repr(seen).startswith(
        "Observation(step=3, frame=15, time=0.3, time_bank=0.0, position=(1.0, 0.0, 0.0)"
    )
    for duplicate in (copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))):  # noqa: S301 - our own
        assert duplicate(observation(step=3)) == observation(step=3)
    weak = dataclasses.replace(observation(step=3, health=80), health=1)
    assert (weak.step, weak.health) == (3, 1)


def test_an_observation_cannot_be_changed() -> None:
    seen = observation(step=3)
    with pytest.raises(dataclasses.FrozenInstanceError):
        seen.step = 4  # type: ignore[misc]
    assert seen.step == 3


@pytest.mark.parametrize("seen", [observation(step=3), dataclasses.replace(observation(step=3))])
def test_a_misspelt_field_of_an_observation_is_named(seen: Observation) -> None:
    with pytest.raises(AttributeError, match="'Observation' object has no attribute 'helth'") as caught:
        _ = seen.helth  # type: ignore[attr-defined]
    assert caught.value.name == "helth"  # so that Python says which one was meant


def test_an_answer_that_is_no_action_is_named() -> None:
    class Mine(Agent):
        pass

    with pytest.raises(
        AgentError, match=r"Mine\.act\(\) must return an Action.*walk_speed.*returned None .*return missing"
    ):
        check_action(Mine(), None)


def test_run_needs_an_address(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("WILDSCAV_ADDRESS", raising=False)
    with pytest.raises(UserError, match="WILDSCAV_ADDRESS is not set"):
        run(Agent)
    assert issubclass(UserError, WildscavError)


@pytest.mark.parametrize(
    ("agent", "code", "errors"),
    [
        (
            "ReturnsThree",
            3,
            "act() must return an Action, such as Action(walk_speed=5.0), and returned 3 of type int",
        ),
        ("Raises", 3, "RuntimeError: my own fault"),
        ("Exits", 3, "SystemExit: 0"),
        ("NoAgent", 3, "NoAgent has no method reset()"),
        ("Missing", 3, "has no class Missing"),
        ("no_such_module:Agent", 3, "No module named 'no_such_module'"),
    ],
)
@with_server
async def test_an_agent_that_fails_is_told_from_a_platform_that_fails(
    served: Served, agent: str, code: int, errors: str
) -> None:
    hosted = await served.host(small_spec())
    process = await start_agent(agent, served.address, hosted.tokens[0])
    got, said = await ended(process)
    assert (got, errors in said) == (code, True), said
    assert "wildscav/sdk" not in said  # the traceback is of the agent's own code
    assert "asyncio" not in said
    hosted.give_up(0, "its process ended")
    assert (await hosted.finished()).seats[0].status == SeatStatus.CRASHED


@pytest.mark.parametrize(
    ("arguments", "code", "errors"),
    [
        ([], 2, "usage: "),
        (["agents"], 2, "must be MODULE:CLASS"),
        # It tries for some seconds.
        pytest.param(["agents:Walker"], 4, "no match server answers at unix:", marks=pytest.mark.slow),
    ],
)
def test_the_launcher_tells_usage_from_a_missing_server(
    tmp_path: Path, arguments: list[str], code: int, errors: str
) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "wildscav.sdk", *arguments],
        cwd=Path(__file__).parents[2] / "helpers" / "agents",
        env={"WILDSCAV_ADDRESS": f"unix:{tmp_path / 'none.sock'}", "WILDSCAV_TOKEN": "x"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == code
    assert errors in done.stderr
    assert "Traceback" not in done.stderr


@with_server
async def test_an_agent_may_run_event_loops_of_its_own(served: Served) -> None:
    hosted = await served.host(small_spec(seconds=1.0))
    process = await start_agent("ThinksInLoops", served.address, hosted.tokens[0])
    assert await ended(process) == (0, "")
    report = (await hosted.finished()).seats[0]
    assert (report.status, report.steps_played) == (SeatStatus.FINISHED, 10)


@pytest.mark.skipif(not hasattr(os, "SCHED_BATCH"), reason="the system has no such policy")
@with_server
async def test_an_agent_that_plays_interrupts_nobody(served: Served) -> None:
    hosted = await served.host(small_spec(seconds=0.5))
    agent = await start_agent("TellsHowItRuns", served.address, hosted.tokens[0])
    code, said = await ended(agent)
    assert code == 0
    assert {int(line) for line in said.split()} == {os.SCHED_BATCH}


@pytest.mark.skipif(not hasattr(os, "SCHED_IDLE"), reason="the system has no such policy")
def test_how_an_agents_user_chose_to_run_it_stays() -> None:
    code = (
        "import os; from wildscav.sdk.run import use_batch_scheduling; "
        "os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0)); "
        "use_batch_scheduling(); chosen = os.sched_getscheduler(0); "
        "os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0)); print(chosen)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.PIPE, text=True)
    assert int(done.stdout) == os.SCHED_IDLE


@with_server
async def test_a_server_that_dies_is_an_unreachable_server(served: Served) -> None:
    hosted = await served.host(small_spec(seats=2))
    agent = await start_agent("Walker", served.address, hosted.tokens[0])
    async with connected(served.address) as other:
        await other.join(hosted.tokens[1])
        await other.read()  # so both are there
        await served.server.stop(grace=0)
    assert (await ended(agent))[0] == 4


@pytest.mark.parametrize(
    ("target", "direction"),
    [((0, 0, 5), 0.0), ((5, 9, 0), 90.0), ((0, 0, -5), 180.0), ((-5, 0, 0), 270.0), ((0, 3, 0), 0.0)],
)
def test_directions_are_those_of_a_compass(target: tuple[float, float, float], direction: float) -> None:
    assert direction_to((0.0, 0.0, 0.0), target) == pytest.approx(direction)
    if flat_distance((0, 0, 0), target):
        assert moved((0, target[1], 0), direction, 5.0) == pytest.approx(target, abs=1e-9)


@pytest.mark.parametrize(
    ("yaw", "direction", "turn"), [(0, 90, 90), (90, 0, -90), (170, 190, 20), (-170, 170, -20), (0, 360, 0)]
)
def test_a_turn_goes_the_short_way(yaw: float, direction: float, turn: float) -> None:
    assert turn_to(yaw, direction) == pytest.approx(turn)


def test_a_pitch_is_positive_downwards_and_starts_at_the_eyes() -> None:
    assert pitch_to((0, 0, 0), (0, 1.5, 10)) == pytest.approx(0)
    assert pitch_to((0, 0, 0), (10, -8.5, 0)) == pytest.approx(45)
    assert pitch_to((0, 0, 0), (0, 20, 0)) == pytest.approx(-90)
