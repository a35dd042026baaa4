"""A seat of words in a match of a real server: one thread plays the agent, another calls tools."""

import asyncio
import threading
from pathlib import Path

import numpy as np
import pytest
from tests.platform.helpers.seats import host, serving, small_spec
from tests.platform.wildscav.skills.observations import match_info, seen

from wildscav_engine.record import read_record, verify_record, write_record
from wildscav_language.calls import Reason
from wildscav_language.seat import Reply, Seat
from wildscav_language.senses import sensors
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

OPEN = np.full((30, 96), 60.0, np.float32)  # what the LIDAR reads where nothing is


def test_a_match_is_played_by_calls_and_its_record_holds(tmp_path: Path) -> None:
    spec = small_spec("navigation", seconds=30.0)
    record = tmp_path / "match.wsr"
    replies: list[Reply] = []

    async def play(server: MatchServer, address: str) -> dict[str, float]:
        clock = Clock(time_bank=60.0)
        hosted = await host(server, spec, sensors={0: sensors()}, clock=clock)
        seat = Seat(hosted.names)
        playing = asyncio.create_task(asyncio.to_thread(seat.play, address, hosted.tokens[0]))
        assert "Target: " in await asyncio.to_thread(seat.observe)
        while not seat.is_over:
            replies.append(await asyncio.to_thread(seat.call, "go", {"place": "target", "seconds": 20.0}))
        await playing
        match = (await hosted.finished()).match
        write_record(record, match, hosted.names)
        return dict(match.result().seats[0].metrics)

    metrics = serving(tmp_path, play)

    assert metrics["success"] == 1.0
    assert verify_record(read_record(record)).holds
    assert replies[-1] == Reply("The match is over.", Reason.MATCH_OVER, 0, over=True)


TARGET = (0.0, 0.0, 30.0)


def playing(seat: Seat, steps: int) -> threading.Thread:
    """Ask a seat's agent for the actions of some steps of standing still, in a thread, and end the match."""

    def play() -> None:
        seat.agent.reset(match_info(track="navigation", target=TARGET))
        for step in range(steps):
            told = {"step": step, "frame": 5 * step, "time": 0.1 * step, "target": TARGET}
            seat.agent.act(seen(tensors={"lidar": OPEN}, **told))
        seat.finish()

    thread = threading.Thread(target=play)
    thread.start()
    return thread


def test_a_tool_plays_steps_and_the_match_waits_between_calls() -> None:
    seat = Seat()
    thread = playing(seat, steps=20)

    reply = seat.call("wait_until", {"seconds": 1.0})

    assert (reply.ended, reply.steps, reply.over) == (Reason.DONE, 10, False)
    assert reply.text.startswith("wait_until ended after 1.0 s: done.")
    assert seat.counts.steps == 10
    last = seat.call("wait_until", {"seconds": 5.0})
    assert (last.ended, last.over) == (Reason.MATCH_OVER, True)
    thread.join()


def test_who_leaves_stands_still() -> None:
    seat = Seat()
    thread = playing(seat, steps=20)
    seat.observe()

    seat.leave()

    thread.join(60.0)
    assert not thread.is_alive()
    assert seat.call("look_around", {}).over


def test_a_caller_need_not_wait_for_the_end_of_a_tool() -> None:
    seat = Seat()
    seat.agent.reset(match_info())
    first = threading.Thread(target=seat.agent.act, args=(seen(tensors={"lidar": OPEN}),))
    first.start()
    seat.observe()  # which waits for it

    assert seat.call("wait_until", {"seconds": 1.0}, timeout=0.1).ended == Reason.PLAYING
    assert seat.wait(timeout=0.0).ended == Reason.PLAYING
    first.join()


def test_a_match_that_does_not_begin() -> None:
    with pytest.raises(TimeoutError, match="has not begun"):
        Seat().observe(timeout=0.01)


def test_one_timeout_is_for_the_whole_call() -> None:
    with pytest.raises(TimeoutError, match="has not begun"):
        Seat().call("look_around", {}, timeout=0.01)
