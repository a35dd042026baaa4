"""Threads share work: every part is done, mostly by the thread that did it the last time."""

import subprocess
import sys
import threading
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.parallel.threads import SharedWork, share
from wildscav_engine.parallel.turns import ALONE, Turns, items_of, turns_of

Do = Callable[[int], bool]  # processes an item


def by_parts(do: Do, count: int, threads: int, least: int = 1) -> bool:
    return share(lambda part: all(map(do, range(part.start, part.stop))), count, threads, least)


def by_turns(do: Do, count: int, threads: int, least: int = 1) -> bool:
    return SharedWork(lambda turns: all(map(do, items_of(turns, count))), count, threads, least).finish()


@pytest.mark.parametrize("shared", [by_parts, by_turns])
@given(count=st.integers(0, 50), least=st.integers(1, 12), threads=st.integers(1, 6))
def test_everything_is_done(shared: Callable[..., bool], count: int, least: int, threads: int) -> None:
    done: list[int] = []

    def do(item: int) -> bool:
        done.append(item)
        return True

    assert shared(do, count, threads, least)
    assert set(done) == set(range(count))
    assert shared is by_turns or len(done) == count  # two threads may come to an item at the same moment


@pytest.mark.parametrize("shared", [by_parts, by_turns])
@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("failing", [0, 3, 7])
def test_a_failure_at_any_item_is_told(shared: Callable[..., bool], threads: int, failing: int) -> None:
    assert not shared(lambda item: item != failing, 8, threads)


@pytest.mark.parametrize("failing", [0, 4])  # the item that each thread begins with
def test_a_failure_in_any_thread_is_told(failing: int) -> None:
    begun = threading.Barrier(2)

    def work(turns: Turns) -> bool:
        begun.wait(60)
        return bool(turns.order[0] != failing)

    assert not SharedWork(work, 8, 2).finish()


def test_each_thread_does_the_same_parts_again() -> None:
    """While all are equally fast, nothing moves from the cache of one processor core to another's."""
    meet = threading.Barrier(2)

    def once() -> dict[int, str]:
        who: dict[int, str] = {}

        def work(part: slice) -> bool:
            who[part.start] = threading.current_thread().name
            meet.wait(120)
            return True

        assert share(work, 8, 2, 4)
        return who

    first = once()
    assert first[0] != first[4]
    assert all(once() == first for _ in range(5))


def test_who_is_done_takes_over_what_another_has_left() -> None:
    first_half: set[str] = set()
    helped = threading.Event()

    def work(part: slice) -> bool:
        if part.start < 4:
            first_half.add(threading.current_thread().name)
            if len(first_half) == 2:
                helped.set()
            if part.start == 0:
                helped.wait(60)  # slow, until the other thread has come to help
        return True

    assert share(work, 8, 2)
    assert helped.is_set(), "the other thread did none of the first half"


def test_no_thread_is_woken_for_less_than_it_should_get() -> None:
    done: list[tuple[slice, str]] = []

    def work(part: slice) -> bool:
        done.append((part, threading.current_thread().name))
        return True

    assert share(work, 9, threads=4, least=5)
    assert done == [(slice(0, 9), threading.current_thread().name)]


def test_processes_need_not_be_able_to_fork() -> None:
    code = "import os; del os.fork, os.register_at_fork; import wildscav_engine.parallel.threads"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


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


def test_other_threads_begin_before_the_calling_one_does() -> None:
    begun = threading.Event()

    def work(turns: Turns) -> bool:
        assert list(turns.order[:1]) == [4], "it is the second half that the other thread begins with"
        begun.set()
        return all(item < 8 for item in items_of(turns, 8))

    shared = SharedWork(lambda turns: turns.order[0] == 0 or work(turns), 8, 2)
    assert begun.wait(60)
    assert shared.finish()


def test_an_error_in_another_thread_is_raised() -> None:
    begun = threading.Barrier(2)

    def work(turns: Turns) -> bool:
        begun.wait(60)
        if turns.order[0] != 0:
            raise ValueError("no image")
        return True

    with pytest.raises(ValueError, match="no image"):
        SharedWork(work, 8, 2).finish()
