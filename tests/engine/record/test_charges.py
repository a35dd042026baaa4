"""Verification of what seats were charged for thinking."""

from dataclasses import replace

import numpy as np
import pytest

from wildscav_engine.record import Record, RecordError, record_of, verify_record
from wildscav_engine.record.format import decode, encode
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.thinking import SeatThinking, Thinking

SPEC = MatchSpec(
    track="gathering",
    map=MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.0), seed=5),
    seats=("submission", "gatherer"),
    time_limit=1.0,
    clock="tokens",
)
# Ten steps of 0.1 s; a token costs 0.02 s: 2 steps in step 1, 1 in step 5 and 7 in step 8, which has no end.
WALKS = [3.0, 3.0, 3.0, 4.0, 5.0, 5.0, 6.0, 7.0, 7.0, 7.0]
CHARGES = [[0, 1, 13, 0, 2], [0, 5, 2, 0, 1], [0, 8, 35, 20_000_000, 7]]


@pytest.fixture(scope="module")
def record() -> Record:
    match = Match(SPEC)
    for walk in WALKS:
        actions = np.zeros((2, 8), np.float32)
        actions[0, 1] = walk
        match.step(actions)
    seats = (SeatThinking(seat=0, decisions=7, seconds=1.5, tokens=50, held=5),)
    match.thinking = Thinking(seats, np.array(CHARGES, np.int64))
    return record_of(match, ["model", "robot"])


def with_charges(record: Record, charges: list[list[int]]) -> Record:
    assert record.thinking is not None
    rows = np.array(charges, np.int64).reshape(-1, 5)
    return replace(record, thinking=record.thinking._replace(charges=rows))


def test_a_record_tells_what_was_charged(record: Record) -> None:
    read = decode(encode(record))
    assert read.thinking is not None
    assert record.thinking is not None
    assert read.thinking.seats == record.thinking.seats
    assert read.thinking.charges.tolist() == CHARGES
    assert verify_record(read).holds


@pytest.mark.parametrize(
    ("charges", "fault"),
    [
        ([[0, 1, 12, 0, 2], [0, 5, 2, 0, 1]], "step 6: seat 0 is charged 1 steps, and its thought costs 0"),
        ([[0, 1, 13, 0, 1]], "step 2: seat 0 is charged 1 steps, and its thought costs 2"),
        ([[0, 1, 13, 0, 2], [0, 3, 2, 0, 1]], "step 4: seat 0 is charged, but it was not asked"),
        ([[0, 2, 10, 0, 2]], "step 4: the last action of seat 0 does not hold while it thinks"),
        ([[0, 10, 1, 0, 0]], "step 11: seat 0 is charged, but it was not asked"),
        ([[1, 1, 5, 0, 1]], "seat 1 is charged for thinking, but no agent fills it"),
        ([[2, 1, 5, 0, 1]], "seat 2 is charged for thinking, but no agent fills it"),
        ([[0, 1, -5, 0, 1]], "a charge is negative"),
    ],
)
def test_charges_that_the_spec_does_not_give_are_named(
    record: Record, charges: list[list[int]], fault: str
) -> None:
    verification = verify_record(with_charges(record, charges))
    assert (verification.holds, verification.message) == (False, fault)


def test_by_another_clock_nothing_may_be_charged(record: Record) -> None:
    paused = replace(record, spec=record.spec.model_copy(update={"clock": "paused"}))
    assert "but the clock is paused" in verify_record(paused).message


@pytest.mark.parametrize(
    ("said", "fault"),
    [
        ({"tokens": 49}, "seat 0 is charged for 50 tokens, but wrote 49"),
        ({"held": 6}, "seat 0 is said to have held 6 steps, but held 5"),
        ({"held": 4}, "seat 0 is said to have held 4 steps, but held 5"),
        (None, "how much agents thought is missing"),
    ],
)
def test_what_is_said_of_thinking_must_agree_with_the_charges(
    record: Record, said: dict[str, int] | None, fault: str
) -> None:
    assert record.thinking is not None
    (seat,), charges = record.thinking
    told = None if said is None else Thinking((seat.model_copy(update=said),), charges)
    verification = verify_record(replace(record, thinking=told))
    assert (verification.holds, verification.message) == (False, fault)


@pytest.mark.parametrize("seats", [[], [1], [0, 0], [7]], ids=str)
def test_how_much_seats_thought_is_of_the_seats_that_agents_fill(record: Record, seats: list[int]) -> None:
    of_seats = tuple(SeatThinking(seat=seat, decisions=0, seconds=0.0) for seat in seats)
    written = replace(record, thinking=Thinking(of_seats, np.zeros((0, 5), np.int64)))
    with pytest.raises(RecordError, match=r"its thinking is not that of the seats \[0\]"):
        decode(encode(written))
