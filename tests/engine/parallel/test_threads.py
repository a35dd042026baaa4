"""Work is shared by threads: every part is done once, by whoever did it the last time if he is not late."""

import subprocess
import sys
import threading

from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.parallel.threads import share


@given(count=st.integers(0, 50), least=st.integers(1, 12), threads=st.integers(1, 6))
def test_everything_is_done_exactly_once(count: int, least: int, threads: int) -> None:
    done: list[int] = []

    def work(part: slice) -> bool:
        done.extend(range(part.start, part.stop))
        return True

    assert share(work, count, threads, least)
    assert sorted(done) == list(range(count))


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


def test_a_failure_is_told() -> None:
    assert not share(lambda part: not part.start <= 3 < part.stop, 8, 1)
    assert not share(lambda part: not part.start <= 3 < part.stop, 8, 3)


def test_processes_need_not_be_able_to_fork() -> None:
    code = "import os; del os.fork, os.register_at_fork; import wildscav_engine.parallel.threads"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
