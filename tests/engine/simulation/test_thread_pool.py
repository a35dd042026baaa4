"""Several threads play a batch together: the same bits, whoever plays which match, and however they sleep."""

import multiprocessing
import os
import threading
import time
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from builders import flat_world, map_from
from wildscav_engine.simulation import thread_pool as crews
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.thread_pool import Crew, crew
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.match_spec import MatchSpec

COUNTRY = map_from(flat_world())


def village(matches: int, seats: int = 3) -> Batch:
    """Return battles that differ in their seeds."""
    specs = [
        MatchSpec(track="battle", map=COUNTRY.spec, seed=seed, seats=("submission",) * seats, time_limit=30)
        for seed in range(matches)
    ]
    return Batch(specs, [COUNTRY] * matches)


def walk(matches: int, step: int, seats: int = 3) -> np.ndarray:
    """Return actions of everybody: all walk, each another way."""
    random = np.random.default_rng(step)
    rows = np.zeros((matches, seats, FIELDS), np.float32)
    rows[..., Field.WALK_DIRECTION] = random.uniform(0, 360, rows.shape[:2])
    rows[..., Field.WALK_SPEED] = 10.0
    rows[..., Field.SHOOT] = 1.0
    return rows


@pytest.fixture
def many_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let batches be played by crews, however few cores there are."""
    monkeypatch.setattr("wildscav_engine.simulation.batch.most_together", lambda: 8)


@pytest.mark.usefixtures("many_cores")
@settings(max_examples=12, deadline=None)
@given(matches=st.integers(2, 9), threads=st.integers(2, 6))
def test_the_same_bits_whoever_plays(matches: int, threads: int) -> None:
    alone, together = village(matches), village(matches)
    for step in range(6):
        actions = walk(matches, step)
        played = alone.step(actions)
        assert together.step(actions, threads=threads).tobytes() == played.tobytes()
    assert [together.get_state(row) for row in range(matches)] == [
        alone.get_state(row) for row in range(matches)
    ]


@pytest.mark.usefixtures("many_cores")
def test_helpers_that_fell_asleep_wake_up_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crews, "LOOKS", 10)
    monkeypatch.setattr(crews, "_crews", crews._Crews())
    alone, together = village(6), village(6)
    for step in range(40):
        time.sleep(0.002 if step % 4 else 0.0)
        alone.step(walk(6, step))
        together.step(walk(6, step), threads=3)
    assert together.state.matches.digest.tobytes() == alone.state.matches.digest.tobytes()


@pytest.mark.usefixtures("many_cores")
def test_a_batch_that_grew_is_played_where_it_lies_now() -> None:
    alone, together = village(4), village(4)
    for batch in (alone, together):
        batch.step(walk(4, 0), threads=2)
        state = village(4).get_state(1)
        batch.set_state(2, state)
        batch.restart([0], [batch.specs[3]], [map_from(flat_world())])
    alone.step(walk(4, 1))
    together.step(walk(4, 1), threads=2)
    assert together.state.matches.digest.tobytes() == alone.state.matches.digest.tobytes()


def helpers() -> int:
    """Return how many helpers there are."""
    return sum(thread.name.startswith("wildscav-") for thread in threading.enumerate())


def wait_for(holds: Callable[[], bool]) -> bool:
    """Return whether something holds within some seconds."""
    end = time.monotonic() + 60
    while not holds() and time.monotonic() < end:
        time.sleep(0.01)
    return holds()


def test_helpers_end_with_their_crew_and_with_their_thread() -> None:
    before = helpers()
    three = Crew(3)
    assert helpers() == before + 2
    del three
    assert wait_for(lambda: helpers() == before)

    thread = threading.Thread(target=crew, args=(2,))
    thread.start()
    thread.join()
    assert wait_for(lambda: helpers() == before)


def _play_in_a_fork(connection: object) -> None:
    batch = village(4)
    batch.step(walk(4, 0), threads=2)
    connection.send(batch.state.matches.digest.tobytes())  # type: ignore[attr-defined]
    os._exit(0)


@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system cannot fork")
@pytest.mark.usefixtures("many_cores")
def test_a_forked_process_starts_helpers_of_its_own() -> None:
    batch = village(4)
    batch.step(walk(4, 0), threads=2)
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe()
    process = context.Process(target=_play_in_a_fork, args=(theirs,))
    process.start()
    assert ours.poll(60), "the forked process waits for helpers that it does not have"
    assert ours.recv() == batch.state.matches.digest.tobytes()
    process.join()
