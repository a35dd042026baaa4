"""Clocks by which thinking costs game time: what holds, what is charged, and what it costs others."""

import numpy as np
import pytest
from tests.platform.helpers.manual_clock import HOP, ServedByHand, answer, with_server_by_hand
from tests.platform.helpers.seats import connected, small_spec

from wildscav_engine.record import Record, record_of, verify_record
from wildscav_engine.record.format import decode, encode
from wildscav_engine.specs.actions import Field
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

STEP = 0.0625  # s that a step of 0.1 s lasts at this pace
RUNNING = {"clock": "running", "thinking": {"pace": 0.1 / STEP}}
TOKENS = {"clock": "tokens", "thinking": {"token_time": 0.01, "processor_time": 1.0}}


class Meter:
    """Says that a seat has spent what a test says."""

    def __init__(self) -> None:
        self.total = 500, 3.0  # before the match began, which costs nothing

    def __call__(self) -> tuple[int, float]:
        return self.total

    def spend(self, tokens: int, processor: float = 0.0) -> None:
        self.total = self.total[0] + tokens, self.total[1] + processor


def record(hosted: HostedMatch) -> Record:
    """Return the match's record as it is read back, which must hold."""
    written = record_of(hosted.match, hosted.names)
    read = decode(encode(written))
    assert encode(read) == encode(written)
    assert verify_record(read).holds, verify_record(read).message
    return read


def walked(played: Record, seat: int) -> list[float]:
    return played.actions[:, seat, Field.WALK_SPEED].tolist()


@with_server_by_hand
async def test_the_world_goes_on_while_a_seat_thinks(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, **RUNNING))
    async with connected(served.address) as slow, connected(served.address) as hung:
        info = (await slow.join(hosted.tokens[0])).match_info
        assert (info.clock, info.step_budget, info.time_bank) == ("running", STEP, 0.0)
        await hung.join(hosted.tokens[1])
        await served.pass_time(3 * STEP + HOP)  # it thinks about step 0 for three steps
        assert hosted.match.step_number == 3
        assert await answer(slow, hosted, 0, walk_speed=2.0, pick_up=True) == 0
        await served.pass_time(2 * STEP)
        assert hosted.match.step_number == 5
        # It got the observation of the step in which its answer arrived.
        assert await answer(slow, hosted, 0, walk_speed=3.0) == 3
        # The next one it gets at once, too: two answers in one step, of which the newer is played.
        assert (await slow.read()).observation.step == 5
        await slow.act(5, walk_speed=4.0)
        await slow.act(5, walk_speed=9.0)  # nobody has asked again
        await served.pass_time(15 * STEP)
    lively, silent = (await hosted.finished()).seats.values()
    assert walked(record(hosted), 0) == [0.0, 0.0, 0.0, 2.0, 2.0, *[4.0] * 15]
    assert record(hosted).actions[:, 0, Field.PICK_UP].tolist() == [0.0, 0.0, 0.0, 1.0, *[0.0] * 16]
    assert (lively.status, lively.steps_played, lively.held_steps) == (SeatStatus.FINISHED, 2, 18)
    assert (lively.late_steps, lively.dropped_actions) == (0, 2)
    assert (silent.status, silent.steps_played, silent.held_steps) == (SeatStatus.FINISHED, 0, 20)
    assert walked(record(hosted), 1) == [0.0] * 20


@with_server_by_hand
async def test_every_step_lasts_equally_long_even_if_all_have_answered(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(**RUNNING))
    async with served.seated(hosted) as (quick,):
        for step in range(20):
            assert await answer(quick, hosted, 0, walk_speed=1.0) == step
            await served.pass_time(STEP - HOP)
            assert hosted.match.step_number == step
            await served.pass_time(HOP)
            assert hosted.match.step_number == step + 1
    assert (await hosted.finished()).seats[0].held_steps == 0


@pytest.mark.parametrize(("late", "ends"), [(1, (17, 32, 48)), (5, (24, 36, 48))])
@with_server_by_hand
async def test_the_servers_own_delay_does_not_slow_down_the_world(
    served: ServedByHand, late: int, ends: tuple[int, ...]
) -> None:
    """A server that is more than 10 ms late reads for as long what has arrived. Times are in hops."""
    hosted = await served.host(small_spec(**RUNNING))
    async with served.seated(hosted) as (seat,):
        await seat.read()
        began, found = served.clock.now, []
        served.clock.now += STEP + late * HOP  # nothing happened meanwhile
        await served.pass_time(0)
        await served.pass_time(0)
        for step in range(3):
            while hosted.match.step_number == step:
                await served.pass_time(HOP)
            found.append((served.clock.now - began) / HOP)
        assert tuple(found) == ends
    hosted.cancel()


@with_server_by_hand
async def test_a_seat_that_leaves_stands_still(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, **RUNNING))
    async with served.seated(hosted) as (leaving, _):
        await answer(leaving, hosted, 0, walk_speed=2.0)
        await served.pass_time(2 * STEP)
        hosted.give_up(0, "killed")
        await served.pass_time(18 * STEP)
    assert (await hosted.finished()).seats[0].status == SeatStatus.CRASHED
    assert walked(record(hosted), 0) == [2.0, 2.0, *[0.0] * 18]


@with_server_by_hand
async def test_a_thought_costs_the_steps_of_its_price(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, **TOKENS))
    meter = Meter()
    hosted.charge_by(0, meter)
    async with connected(served.address) as model, connected(served.address) as other:
        assert (await model.join(hosted.tokens[0])).match_info.clock == "tokens"
        await other.join(hosted.tokens[1])
        for step in range(2):  # thinks for nothing
            assert await answer(model, hosted, 0, walk_speed=2.0, jump=True) == step
            assert await answer(other, hosted, 1, walk_speed=1.0) == step
        await served.pass_time(40.0)  # the match stands still
        assert hosted.match.step_number == 2
        meter.spend(30, 0.05)  # 0.3 s and 0.05 s: three steps, and half a step is owed on
        assert await answer(model, hosted, 0, walk_speed=5.0) == 2
        await model.act(2, walk_speed=9.0)  # one answer too many
        for step in range(2, 6):
            assert await answer(other, hosted, 1, walk_speed=1.0) == step
        assert hosted.match.step_number == 6
        meter.spend(5)  # with what is owed, a step
        assert await answer(model, hosted, 0, walk_speed=7.0) == 6
        for step in range(6, 8):
            assert await answer(other, hosted, 1, walk_speed=1.0) == step
        meter.spend(10**6)  # more than the match has
        assert await answer(model, hosted, 0, walk_speed=9.0) == 8
        for step in range(8, 20):
            assert await answer(other, hosted, 1, walk_speed=1.0) == step
    report = (await hosted.finished()).seats[0]
    played = record(hosted)
    assert walked(played, 0) == [2.0, 2.0, 2.0, 2.0, 2.0, 5.0, 5.0, *[7.0] * 13]
    assert played.actions[:, 0, Field.JUMP].tolist() == [1.0, 1.0, *[0.0] * 18]  # no press is repeated
    assert walked(played, 1) == [1.0] * 20
    assert played.thinking is not None
    assert played.thinking.charges.tolist() == [
        [0, 2, 30, 50_000_000, 3],
        [0, 6, 5, 0, 1],
        [0, 8, 10**6, 0, 100_000],
    ]
    assert (report.tokens, report.processor, report.held_steps) == (1_000_035, 0.05, 16)
    assert (report.status, report.think_time.total) == (SeatStatus.FINISHED, 40.0)
    assert (report.steps_played, report.dropped_actions) == (5, 1)


@with_server_by_hand
async def test_when_all_seats_pay_for_their_thoughts_the_match_plays_on(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, **TOKENS))
    meters = Meter(), Meter()
    async with connected(served.address) as first, connected(served.address) as second:
        for number, seat in enumerate((first, second)):
            hosted.charge_by(number, meters[number])
            await seat.join(hosted.tokens[number])
        for step in range(0, 20, 5):
            for number, seat in enumerate((first, second)):
                meters[number].spend(40)
                assert await answer(seat, hosted, number, walk_speed=1.0) == step
    outcome = await hosted.finished()
    assert [one.held_steps for one in outcome.seats.values()] == [16, 16]
    record(hosted)


@with_server_by_hand
async def test_a_seat_that_leaves_while_it_pays_does_nothing(served: ServedByHand) -> None:
    hosted = await served.host(small_spec(seats=2, **TOKENS))
    meter = Meter()
    hosted.charge_by(0, meter)
    async with served.seated(hosted) as (model, other):
        await answer(model, hosted, 0, walk_speed=2.0)
        await answer(other, hosted, 1)
        meter.spend(100)
        await answer(model, hosted, 0, walk_speed=3.0)
        for step in range(1, 20):
            if step == 4:
                hosted.give_up(0, "killed")
            assert await answer(other, hosted, 1) == step
    await hosted.finished()
    assert walked(record(hosted), 0) == [2.0, 2.0, 2.0, 2.0, *[0.0] * 16]


@with_server_by_hand
async def test_a_hung_seat_is_closed_alone_and_a_budget_bounds_all_answers(served: ServedByHand) -> None:
    priced = {"clock": "tokens", "thinking": {"budget": 5.0}}
    hosted = await served.host(small_spec(seats=2, **priced), clock=Clock(step_budget=STEP))
    async with connected(served.address) as hung, connected(served.address) as other:
        info = (await hung.join(hosted.tokens[0])).match_info
        assert info.time_bank == 5.0
        await other.join(hosted.tokens[1])
        await answer(other, hosted, 1)
        await served.pass_time(5.0 + 2 * STEP)
        for step in range(1, 20):
            assert await answer(other, hosted, 1) == step
    closed, lively = (await hosted.finished()).seats.values()
    assert (closed.status, closed.detail) == (SeatStatus.TIMED_OUT, "its time bank of 5 s was used up")
    assert (lively.status, lively.steps_played) == (SeatStatus.FINISHED, 20)


@pytest.mark.parametrize("clock", ["bank", "paused"])
@with_server_by_hand
async def test_where_thinking_costs_no_game_time_nothing_is_charged(served: ServedByHand, clock: str) -> None:
    hosted = await served.host(small_spec(clock=clock))
    meter = Meter()
    hosted.charge_by(0, meter)
    async with served.seated(hosted) as (seat,):
        for step in range(20):
            meter.spend(7, 0.25)
            assert await answer(seat, hosted, 0, walk_speed=1.0) == step
    report = (await hosted.finished()).seats[0]
    assert (report.tokens, report.processor, report.held_steps) == (140, 5.0, 0)
    thinking = record(hosted).thinking
    if clock == "bank":  # its records are as they always were
        assert thinking is None
    else:
        assert thinking is not None
        assert [(one.decisions, one.tokens) for one in thinking.seats] == [(20, 140)]
        assert not len(thinking.charges)
    assert np.all(record(hosted).actions[:, 0, Field.WALK_SPEED] == 1.0)
