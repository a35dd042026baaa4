"""Matches over the wire: what a seat gets, what it may do, and what its failings cost the others."""

import asyncio
from pathlib import Path

import numpy as np
import pytest
from tests.platform.helpers.seats import (
    Served,
    connected,
    ended,
    host,
    seated,
    serving,
    small_spec,
    start_agent,
    with_server,
)

from wildscav.agent import ACTION_FIELDS
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import Field, no_actions
from wildscav_engine.tracks import TRACKS
from wildscav_server.hosting.hosted_match import MatchCancelledError
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

PATIENT = Clock(step_budget=20.0, time_bank=60.0)


@pytest.mark.parametrize("track", TRACKS)
@with_server
async def test_agents_in_processes_play_every_track(served: Served, track: str) -> None:
    hosted = await served.host(small_spec(track, seats=2))
    agents = [await start_agent("Walker", served.address, token) for token in hosted.tokens.values()]
    outcome = await hosted.finished()
    assert [await ended(agent) for agent in agents] == [(0, ""), (0, "")]
    for report in outcome.seats.values():
        assert report.status == SeatStatus.FINISHED, report
        assert report.steps_played == outcome.match.step_number == 20
        assert report.late_steps == report.dropped_actions == report.invalid_actions == 0
        assert 0 < report.think_time.p50 <= report.think_time.p99 <= report.think_time.max
    assert outcome.match.over


def test_a_served_match_is_the_same_as_one_played_in_the_engine(tmp_path: Path) -> None:
    spec = small_spec("battle", filled_by=("submission", "fighter"))
    numbers = {"walk_direction": 325.5, "walk_speed": 6.25, "turn": -3.5, "look": 1.5}
    fields = {**numbers, "jump": True, "shoot": True}

    async def play(server: MatchServer, address: str) -> list[int]:
        hosted = await host(server, spec)
        async with seated(address, hosted) as (seat,):
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


@with_server
async def test_a_reading_larger_than_a_frame_is_sent_in_parts(served: Served) -> None:
    hosted = await served.host(small_spec(), sensors={0: {"depth": {"width": 160, "height": 160}}})
    async with served.seated(hosted) as (seat,):
        for step in range(4):
            (depth,) = (await seat.read()).observation.tensors
            assert len(np.frombuffer(depth.data, depth.dtype)) == 25_600
            await seat.act(step)
    hosted.cancel()


@with_server
async def test_actions_out_of_range_and_fields_without_a_weapon_are_counted(served: Served) -> None:
    hosted = await served.host(small_spec(seconds=0.3))
    async with served.seated(hosted) as (seat,):
        for step, fields in enumerate(({"walk_speed": 10.01}, {"shoot": True, "reload": True}, {})):
            await seat.read()
            await seat.act(step, **fields)
        over = (await seat.read()).match_over
    for conduct in ((await hosted.finished()).seats[0], over.conduct):
        assert (conduct.invalid_actions, conduct.ignored_fields, conduct.steps_played) == (1, 2, 3)
    assert not hosted.match.actions_played[0].any()


@pytest.mark.parametrize("agent", ["Walker", "Sleepy"], ids=["waiting", "thinking"])
@with_server
async def test_a_cancelled_match_says_so_to_its_seats_and_its_host(served: Served, agent: str) -> None:
    hosted = await served.host(small_spec(seats=2))
    process = await start_agent(agent, served.address, hosted.tokens[0])
    async with connected(served.address) as seat:
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
