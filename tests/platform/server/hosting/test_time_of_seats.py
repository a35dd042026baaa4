"""The time of seats: what the silent and the late lose, and what they cost the others."""

import asyncio

import grpc
import numpy as np
import pytest
from numpy.typing import NDArray
from tests.platform.helpers.manual_clock import (
    HOP,
    HandSetLoop,
    ServedByHand,
    answer,
    has_answered,
    with_server_by_hand,
)
from tests.platform.helpers.seats import connected, ended, small_spec, start_agent

from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

TURN = 1 / 16  # s after which a step is closed that nobody answers: its budget is up half a hop before
BUDGET, BANK = TURN - HOP / 2, 1 / 8  # s
HASTY = Clock(step_budget=BUDGET, time_bank=BANK)


@with_server_by_hand
async def test_a_silent_seat_costs_the_others_its_time_once(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2), clock=HASTY)
    async with served.seated(hosted) as (_, lively):
        began = served.clock.time()
        for step in range(20):
            assert await answer(lively, hosted, 1, walk_speed=1.0) == step
            if step == 0:
                await served.pass_time(TURN + BANK - HOP)
                assert hosted.match.step_number == 0
                await served.pass_time(HOP)
            else:  # the bank is used up
                await served.pass_time(TURN)
            assert hosted.match.step_number == step + 1
        assert served.clock.time() - began == BANK + 20 * TURN
        assert (await lively.read()).match_over.conduct.steps_played == 20
    outcome = await hosted.finished()
    assert outcome.seats[0].status == SeatStatus.TIMED_OUT
    assert (outcome.seats[0].steps_played, outcome.seats[0].late_steps) == (0, 20)
    assert outcome.seats[1].status == SeatStatus.FINISHED


@with_server_by_hand
async def test_each_observation_tells_what_is_left_of_the_seats_own_bank(served: ServedByHand) -> None:
    limits = Clock(step_budget=BUDGET, time_bank=2.0)
    hosted = await served.host(small_spec(seats=2), clock=limits)
    async with served.seated(hosted) as (slow, quick):
        for step in range(3):
            left = 2.0 - step * (0.25 + HOP / 2)
            banks = [(await seat.read()).observation.time_bank for seat in (slow, quick)]
            assert banks == [left, 2.0]
            await quick.act(step)
            await has_answered(hosted, 1, step)
            await served.pass_time(TURN + 0.25)
            await slow.act(step)
            await has_answered(hosted, 0, step)
    hosted.cancel()


@with_server_by_hand
async def test_a_seat_that_wakes_up_again_plays_on(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, seconds=3.0), clock=HASTY)
    async with served.seated(hosted) as (sleepy, lively):
        for step in range(3):
            assert await answer(sleepy, hosted, 0, walk_speed=1.0) == step
            assert await answer(lively, hosted, 1, walk_speed=1.0) == step
        assert (await sleepy.read()).observation.step == 3  # and falls asleep over it
        for step in range(3, 10):
            assert await answer(lively, hosted, 1, walk_speed=1.0) == step
            await served.pass_time(TURN + BANK if step == 3 else TURN)
        await sleepy.act(3)
        assert (await sleepy.read()).observation.step == 10  # the one that is open
        await sleepy.act(10)
        await has_answered(hosted, 0, 3)
        assert await answer(lively, hosted, 1, walk_speed=1.0) == 10
        for step in range(11, 30):
            assert await answer(sleepy, hosted, 0, walk_speed=1.0) == step
            assert await answer(lively, hosted, 1, walk_speed=1.0) == step
    asleep, awake = (await hosted.finished()).seats.values()
    assert (asleep.status, awake.detail) == (SeatStatus.TIMED_OUT, "")
    assert asleep.detail.startswith("its time bank was used up, and step 3 was the first")
    # Steps 3 to 9 were played without it; its answer to step 3 came too late.
    assert (asleep.steps_played, asleep.late_steps, asleep.dropped_actions) == (23, 7, 1)
    assert (awake.status, awake.steps_played) == (SeatStatus.FINISHED, 30)


@with_server_by_hand
async def test_a_paused_match_waits_for_every_answer(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, clock="paused"), clock=HASTY)
    async with connected(served.address) as slow, connected(served.address) as quick:
        info = (await slow.join(hosted.tokens[0])).match_info
        assert (info.clock, info.step_budget, info.time_bank) == ("paused", BUDGET, 3600.0)
        await quick.join(hosted.tokens[1])
        for step in range(20):
            assert await answer(quick, hosted, 1, walk_speed=1.0) == step
            await served.pass_time(40.0 if step % 10 == 0 else HOP)  # far more than budget and bank
            assert hosted.match.step_number == step
            assert await answer(slow, hosted, 0, walk_speed=1.0) == step
    for report in (await hosted.finished()).seats.values():
        assert (report.status, report.steps_played, report.late_steps) == (SeatStatus.FINISHED, 20, 0)


@pytest.mark.parametrize(
    ("limits", "detail"),
    [
        (Clock(idle_limit=BUDGET), f"gave no answer for {BUDGET:g} s"),
        (
            Clock(step_budget=BUDGET / 2, paused_bank=BUDGET / 2),
            f"its time bank of {BUDGET / 2:g} s was used up",
        ),
    ],
)
@with_server_by_hand
async def test_a_seat_that_gives_no_answer_in_a_paused_match_is_closed_alone(
    served: ServedByHand, limits: Clock, detail: str
) -> None:
    hosted = await served.host(small_spec(seats=2, clock="paused"), clock=limits)
    async with served.seated(hosted) as (silent, lively):
        assert await answer(silent, hosted, 0, walk_speed=1.0) == 0
        assert await answer(lively, hosted, 1, walk_speed=1.0) == 0
        await silent.read()
        assert await answer(lively, hosted, 1, walk_speed=1.0) == 1
        await served.pass_time(TURN)
        for step in range(2, 20):  # nobody waits for it any longer
            assert await answer(lively, hosted, 1, walk_speed=1.0) == step
        with pytest.raises(grpc.aio.AioRpcError, match=detail):
            await silent.read()
    closed, other = (await hosted.finished()).seats.values()
    assert (closed.status, closed.steps_played, closed.late_steps) == (SeatStatus.TIMED_OUT, 1, 1)
    assert closed.detail == detail
    assert (other.status, other.steps_played) == (SeatStatus.FINISHED, 20)


@with_server_by_hand
async def test_a_seat_whose_answer_is_late_in_a_paused_match_is_closed(served: ServedByHand) -> None:
    limits = Clock(step_budget=BUDGET, paused_bank=2 * TURN)
    hosted = await served.host(small_spec(seats=2, clock="paused"), clock=limits)
    async with served.seated(hosted) as (slow, lively):
        assert await answer(lively, hosted, 1) == 0
        await served.pass_time(2 * TURN)
        assert await answer(slow, hosted, 0) == 0
        await slow.read()
        await lively.read()
        await served.pass_time(2 * TURN + HOP)  # the other's bank would pay for it
        await slow.act(1, walk_speed=1.0)
        with pytest.raises(grpc.aio.AioRpcError, match="was used up"):
            await slow.read()
        await lively.act(1)
        for step in range(2, 20):
            assert await answer(lively, hosted, 1) == step
    closed, other = (await hosted.finished()).seats.values()
    assert (closed.status, closed.steps_played, closed.late_steps) == (SeatStatus.TIMED_OUT, 1, 1)
    assert (other.status, other.steps_played) == (SeatStatus.FINISHED, 20)


@with_server_by_hand
async def test_a_killed_agent_costs_nobody_any_time(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2))
    agents = [
        await start_agent(name, served.address, hosted.tokens[seat])
        for seat, name in enumerate(("Killed", "Walker"))
    ]
    outcome = await hosted.finished()  # no time has passed, so nobody waited for the bank of 30 s
    assert (await ended(agents[0]))[0] == -9
    assert await ended(agents[1]) == (0, "")
    assert (outcome.seats[0].status, outcome.seats[0].steps_played) == (SeatStatus.CRASHED, 5)
    assert outcome.seats[0].detail == "its stream ended"
    assert (outcome.seats[1].status, outcome.seats[1].steps_played) == (SeatStatus.FINISHED, 20)


@with_server_by_hand
async def test_when_all_are_gone_the_rest_is_played_at_once(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seconds=600.0))
    async with served.seated(hosted) as (seat,):
        await seat.read()
        await seat.call.done_writing()
        outcome = await hosted.finished()
    assert outcome.match.step_number == 6000
    assert (outcome.seats[0].status, outcome.seats[0].detail) == (SeatStatus.CRASHED, "its stream ended")


@with_server_by_hand
async def test_a_seat_that_nobody_takes_is_waited_for_no_longer_than_agreed(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2), clock=Clock(join_timeout=0.5))
    async with connected(served.address) as seat, connected(served.address) as late:
        await seat.join(hosted.tokens[0])
        await served.pass_time(0.5 - HOP)
        assert not hosted.playing
        await served.pass_time(HOP)
        first = await seat.read()
        with pytest.raises(grpc.aio.AioRpcError, match="seat 1 is closed"):
            await late.join(hosted.tokens[1])
        await seat.act(first.observation.step)
        await seat.play_out()
    outcome = await hosted.finished()
    assert outcome.seats[1].status == SeatStatus.NEVER_JOINED
    assert outcome.seats[0].status == SeatStatus.FINISHED


@with_server_by_hand
async def test_the_time_to_join_begins_when_all_agents_were_launched(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2), clock=Clock(join_timeout=0.5), starting=True)
    async with connected(served.address) as first, connected(served.address) as second:
        for seat in range(2):
            await served.pass_time(1.0)  # which its sandbox takes to start
            hosted.launched(seat)
        await served.pass_time(0.5 - HOP)
        await first.join(hosted.tokens[0])
        await second.join(hosted.tokens[1])
        await asyncio.gather(first.play_out(), second.play_out())
    outcome = await hosted.finished()
    assert [outcome.seats[seat].status for seat in range(2)] == ["finished", "finished"]


@with_server_by_hand
async def test_a_seat_given_up_by_its_launcher_is_waited_for_no_longer(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=3))
    hosted.give_up(2, "the process did not start")
    async with connected(served.address) as stuck, connected(served.address) as lively:
        await stuck.join(hosted.tokens[0])
        await lively.join(hosted.tokens[1])
        await lively.read()
        await lively.act(0)
        hosted.give_up(0, "out of memory")
        await lively.play_out()
    outcome = await hosted.finished()
    assert [outcome.seats[seat].status for seat in range(3)] == ["crashed", "finished", "crashed"]
    assert outcome.seats[0].detail == "out of memory"
    assert outcome.seats[2].detail == "the process did not start"


@with_server_by_hand
async def test_two_matches_at_once_do_not_wait_for_each_other(served: ServedByHand) -> None:
    slow, fast = await asyncio.gather(served.host(small_spec()), served.host(small_spec("navigation")))
    async with connected(served.address) as waiting, connected(served.address) as seat:
        await waiting.join(slow.tokens[0])
        await waiting.read()
        await seat.join(fast.tokens[0])
        await seat.play_out()
        assert (await fast.finished()).seats[0].status == SeatStatus.FINISHED
        assert slow.match.step_number == 0
        await waiting.act(0)
        await waiting.play_out()
        assert (await slow.finished()).seats[0].status == SeatStatus.FINISHED


class SlowSensor:
    """A sensor that takes some time to read."""

    def __init__(self, clock: HandSetLoop, takes: float) -> None:
        self._clock, self._takes = clock, takes

    def read(self, match: object, seats: list[int]) -> list[NDArray[np.float32]]:
        self._clock.now += self._takes
        return [np.zeros(1, np.float32)]


@pytest.mark.parametrize("slow", [0, 1], ids=["asked first", "asked last"])
@with_server_by_hand
async def test_a_seat_pays_for_its_sensors_itself(served: ServedByHand, slow: int) -> None:
    takes, bank = 0.375, 2.0
    limits = Clock(step_budget=BUDGET, time_bank=bank)
    hosted = await served.host(small_spec(seats=2), clock=limits)
    hosted.seats[slow].sensors["slow"] = SlowSensor(served.clock, takes)  # type: ignore[assignment]
    async with connected(served.address) as first, connected(served.address) as second:
        seats = (first, second)
        for number, seat in enumerate(seats):
            await seat.join(hosted.tokens[number])
        for step in range(3):
            for seat in seats:
                assert (await seat.read()).observation.step == step
            for number, seat in enumerate(seats):
                await seat.act(step)
                await has_answered(hosted, number, step)
        reports = [hosted.seats[number].report() for number in range(2)]
        hosted.cancel()
    assert reports[slow].time_bank == bank - 3 * (takes - BUDGET)
    assert reports[1 - slow].time_bank == bank
    assert [report.think_time.total for report in reports] == [0.0, 0.0]  # neither has thought


@with_server_by_hand
async def test_a_seat_whose_sensors_take_longer_than_it_has_is_asked_no_more(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2), clock=HASTY)
    hosted.seats[0].sensors["slow"] = SlowSensor(served.clock, 1.0)  # type: ignore[assignment]
    async with served.seated(hosted) as (slow, lively):
        began = served.clock.time()
        await slow.read()
        for step in range(20):
            assert await answer(lively, hosted, 1, walk_speed=1.0) == step
            if step == 2:
                await slow.act(0)  # far too late
            while hosted.match.step_number == step:
                await served.pass_time(HOP)
        assert served.clock.time() - began < 1.0 + 21 * TURN  # the sensor was read once
    asleep, awake = (await hosted.finished()).seats.values()
    assert (asleep.status, asleep.steps_played) == (SeatStatus.TIMED_OUT, 0)
    assert (awake.status, awake.steps_played, awake.time_bank) == (SeatStatus.FINISHED, 20, BANK)
