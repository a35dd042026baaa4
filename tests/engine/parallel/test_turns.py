"""Threads share items: each item is processed, and mostly by the thread that did it before."""

import threading

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.parallel.threads import SharedWork
from wildscav_engine.parallel.turns import ALONE, Turns, items_of, turns_of


@given(count=st.integers(0, 40), threads=st.integers(2, 5))
def test_every_thread_comes_to_every_item_and_to_its_own_first(count: int, threads: int) -> None:
    all_turns = turns_of(count, threads)
    assert all(sorted(turns.order) == list(range(count)) for turns in all_turns)
    share = count // threads
    assert len({int(item) for turns in all_turns for item in turns.order[:share]}) == share * threads


def test_a_thread_that_helps_another_begins_where_that_one_comes_last() -> None:
    first, second = turns_of(6, 2)
    assert first.order.tolist() == [0, 1, 2, 5, 4, 3]
    assert second.order.tolist() == [3, 4, 5, 2, 1, 0]


@given(count=st.integers(0, 40), threads=st.integers(2, 5), data=st.data())
def test_threads_that_take_turns_process_each_item_once(
    count: int, threads: int, data: st.DataObject
) -> None:
    waiting = [items_of(turns, count) for turns in turns_of(count, threads)]
    done: list[int] = []
    while waiting:
        thread = data.draw(st.sampled_from(waiting))
        item = next(thread, None)
        if item is None:
            waiting.remove(thread)
        else:
            done.append(item)
    assert sorted(done) == list(range(count))


def test_a_thread_that_is_alone_processes_all_in_order() -> None:
    assert list(items_of(ALONE, 4)) == [0, 1, 2, 3]


@given(count=st.integers(0, 50), least=st.integers(1, 12), threads=st.integers(1, 6))
def test_all_is_done_once_the_work_is_finished(count: int, least: int, threads: int) -> None:
    done = np.zeros(count, np.int64)

    def work(turns: Turns) -> bool:
        done[list(items_of(turns, count))] = 1
        return True

    assert SharedWork(work, count, threads, least).finish()
    assert done.all()


def test_other_threads_begin_before_the_calling_one_does() -> None:
    begun = threading.Event()

    def work(turns: Turns) -> bool:
        assert list(turns.order[:1]) == [4], "it is the second half that the other thread begins with"
        begun.set()
        return all(item < 8 for item in items_of(turns, 8))

    shared = SharedWork(lambda turns: turns.order[0] == 0 or work(turns), 8, 2)
    assert begun.wait(60)
    assert shared.finish()


def test_a_failure_in_any_thread_is_told() -> None:
    for failing in (0, 4):
        begun = threading.Barrier(2)

        def work(turns: Turns, failing: int = failing, begun: threading.Barrier = begun) -> bool:
            begun.wait(60)
            return bool(turns.order[0] != failing)

        assert not SharedWork(work, 8, 2).finish()


def test_an_error_in_another_thread_is_raised() -> None:
    begun = threading.Barrier(2)

    def work(turns: Turns) -> bool:
        begun.wait(60)
        if turns.order[0] != 0:
            raise ValueError("no image")
        return True

    with pytest.raises(ValueError, match="no image"):
        SharedWork(work, 8, 2).finish()
