"""Matches over the wire: what a seat gets, what it may do, and what its failings cost the others."""

import asyncio
import math
from pathlib import Path

import numpy as np
import pytest
from tests.platform.helpers.seats import connected, ended, host, serving, small_spec, start_agent

from wildscav.agent import ACTION_FIELDS
from wildscav.wire.observations import decode_observation
from wildscav_engine.sensors import SENSORS
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import Field, no_actions
from wildscav_engine.tracks import TRACKS
from wildscav_server.hosting.hosted_match import MatchCancelledError
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

PATIENT = Clock(step_budget=20.0, time_bank=60.0)


@pytest.mark.parametrize("track", TRACKS)
def test_agents_in_processes_play_every_track(tmp_path: Path, track: str) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(track, seats=2))
        agents = [await start_agent("Walker", address, token) for token in hosted.tokens.values()]
        outcome = await hosted.finished()
        assert [await ended(agent) for agent in agents] == [(0, ""), (0, "")]
        for report in outcome.seats.values():
            assert report.status == SeatStatus.FINISHED, report
            assert report.steps_played == outcome.match.step_number == 20
            assert report.late_steps == report.dropped_actions == report.invalid_actions == 0
            assert 0 < report.think_time.p50 <= report.think_time.p99 <= report.think_time.max
        assert outcome.match.over

    serving(tmp_path, play)


def test_a_served_match_is_the_same_as_one_played_in_the_engine(tmp_path: Path) -> None:
    spec = small_spec("battle", filled_by=("submission", "fighter"))
    fields = {
        "walk_direction": 325.5,
        "walk_speed": 6.25,
        "turn": -3.5,
        "look": 1.5,
        "jump": True,
        "shoot": True,
    }

    async def play(server: MatchServer, address: str) -> list[int]:
        hosted = await host(server, spec)
        async with connected(address) as seat:
            await seat.join(hosted.tokens[0])
            await seat.play_out(**fields)
        return (await hosted.finished()).match.digests

    alone = Match(spec)
    rows = no_actions(2)
    for name, value in fields.items():
        rows[0, Field[name.upper()]] = value
    while not alone.over:
        alone.step(rows)
    assert serving(tmp_path, play) == alone.digests


def test_the_columns_of_the_wire_are_those_of_the_engine() -> None:
    assert tuple(field.name.lower() for field in Field) == tuple(ACTION_FIELDS)


def test_an_observation_tells_the_state_of_the_engine(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(
            server, small_spec("battle", seats=2), sensors={0: {"depth": {"width": 8, "height": 5}}}
        )
        async with connected(address) as seat, connected(address) as other:
            info = (await seat.join(hosted.tokens[0])).match_info
            await other.join(hosted.tokens[1])
            assert (info.track, info.seat, info.seats, info.map_size) == ("battle", 0, 2, 40)
            assert (info.start.x, info.start.y, info.start.z) == hosted.match.start_info(0).position
            for step in range(3):
                observation = (await seat.read()).observation
                agents = hosted.match.state.agents
                assert observation.step == step
                assert observation.frame == 5 * step
                place = observation.position
                assert [place.x, place.y, place.z] == agents.position[0, 0].tolist()
                assert observation.yaw == agents.yaw[0, 0]
                assert observation.health == agents.health[0, 0]
                assert len(observation.supply_boxes) == hosted.match.seen.supply_count[0, 0]
                (depth,) = observation.tensors
                assert (depth.name, depth.dtype, list(depth.shape)) == ("depth", "<f4", [5, 8])
                assert len(np.frombuffer(depth.data, depth.dtype)) == 40
                assert not (await other.read()).observation.tensors
                await seat.act(step, turn=3.0)
                await other.act(step)
        hosted.cancel()

    serving(tmp_path, play)


def test_a_step_of_one_agent_takes_one_turn_of_the_loop(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    turns, run_once = [0], asyncio.BaseEventLoop._run_once

    def counted(loop: asyncio.BaseEventLoop) -> None:
        turns[0] += 1
        run_once(loop)

    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(seconds=20.0), clock=PATIENT)
        agent = await start_agent("Walker", address, hosted.tokens[0])
        outcome = await hosted.finished()
        assert outcome.match.step_number == 200
        assert await ended(agent) == (0, "")

    monkeypatch.setattr(asyncio.BaseEventLoop, "_run_once", counted)
    serving(tmp_path, play)
    assert turns[0] < 300, "the start and the end included"


def test_a_reading_larger_than_a_frame_is_sent_in_parts(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(), sensors={0: {"depth": {"width": 160, "height": 160}}})
        async with connected(address) as seat:
            await seat.join(hosted.tokens[0])
            for step in range(4):
                (depth,) = (await seat.read()).observation.tensors
                assert len(np.frombuffer(depth.data, depth.dtype)) == 25_600
                await seat.act(step)
        hosted.cancel()

    serving(tmp_path, play)


def test_an_agent_reads_its_depth_map(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(), sensors={0: {"depth": {"width": 8, "height": 5}}})
        agent = await start_agent("SeesDepth", address, hosted.tokens[0])
        assert await ended(agent) == (0, "")

    serving(tmp_path, play)


def test_an_agent_that_asks_for_all_sensors_gets_them_in_every_step(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> None:
        sensors: dict[str, dict[str, object]] = {name: {} for name in SENSORS}
        hosted = await host(server, small_spec("battle", seats=2), sensors={0: sensors}, clock=PATIENT)
        agents = [
            await start_agent(name, address, token)
            for name, token in zip(("SeesAll", "Walker"), hosted.tokens.values(), strict=True)
        ]
        outcome = await hosted.finished()
        assert [await ended(agent) for agent in agents] == [(0, ""), (0, "")]
        assert outcome.seats[0].steps_played == outcome.match.step_number == 20

    serving(tmp_path, play)


@pytest.mark.parametrize("name", SENSORS)
def test_every_bit_of_every_sensor_crosses_the_wire(tmp_path: Path, name: str) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec("battle", seats=2), sensors={0: {name: {}}})
        async with connected(address) as seat, connected(address) as other:
            await seat.join(hosted.tokens[0])
            await other.join(hosted.tokens[1])
            observation = (await seat.read()).observation
            (arrived,) = decode_observation(observation, 50).tensors.items()
            right = SENSORS[name]().read(hosted.match, [0])[0]
            assert arrived[0] == name
            assert arrived[1].dtype == right.dtype
            assert arrived[1].shape == right.shape
            assert arrived[1].tobytes() == right.tobytes()
        hosted.cancel()

    serving(tmp_path, play)


@pytest.mark.parametrize(
    ("fields", "invalid", "ignored"),
    [
        ({"walk_speed": 10.0}, 0, 0),
        ({"walk_speed": 10.01}, 1, 0),
        ({"walk_speed": -0.01}, 1, 0),
        ({"walk_speed": math.nan}, 1, 0),
        ({"walk_speed": math.inf}, 1, 0),
        ({"turn": math.nan}, 1, 0),
        ({"walk_direction": -math.inf, "walk_speed": 1.0}, 1, 0),
        ({"look": 1e38, "walk_direction": -1e38}, 0, 0),  # any finite angle will do
        ({"pick_up": True}, 0, 0),
        ({"shoot": True, "reload": True}, 0, 2),  # gathering has no weapon
    ],
)
def test_what_an_action_may_hold(
    tmp_path: Path, fields: dict[str, float], invalid: int, ignored: int
) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(seconds=0.1))
        async with connected(address) as seat:
            await seat.join(hosted.tokens[0])
            over = (await seat.play_out(**fields)).match_over
        report = (await hosted.finished()).seats[0]
        assert (report.invalid_actions, report.ignored_fields, report.steps_played) == (invalid, ignored, 1)
        assert (over.conduct.invalid_actions, over.conduct.ignored_fields) == (invalid, ignored)
        if invalid:
            assert not hosted.match.actions_played[0].any()

    serving(tmp_path, play)


@pytest.mark.parametrize("agent", ["Walker", "Sleepy"], ids=["waiting", "thinking"])
def test_a_cancelled_match_says_so_to_its_seats_and_its_host(tmp_path: Path, agent: str) -> None:
    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec(seats=2))
        process = await start_agent(agent, address, hosted.tokens[0])
        async with connected(address) as seat:
            await seat.join(hosted.tokens[1])
            for step in range(3):
                await seat.read()
                await seat.act(step)
            await seat.read()
            await asyncio.sleep(0.2)  # the agent has answered and waits, or is asleep over its answer
            hosted.cancel()
            with pytest.raises(MatchCancelledError):
                await hosted.finished()
        code, errors = await ended(process)
        assert code == 4
        assert "MATCH_CANCELLED" in errors

    serving(tmp_path, play)
