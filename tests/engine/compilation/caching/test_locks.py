"""Processes take turns, and one that cannot lock goes on without."""

import threading
from pathlib import Path

from wildscav_engine.compilation.caching.locks import Lock, locked


def test_one_waits_while_another_has_the_lock(tmp_path: Path) -> None:
    file, order = tmp_path / "some.lock", ["first"]
    waits = threading.Event()

    def wait() -> None:
        with locked(file, waits.set):
            order.append("second")

    with locked(file):
        waiter = threading.Thread(target=wait)
        waiter.start()
        waits.wait()
        order.append("first is done")
    waiter.join()

    assert order == ["first", "first is done", "second"]


def test_nobody_is_told_to_wait_for_what_is_free(tmp_path: Path) -> None:
    waits = threading.Event()
    with locked(tmp_path / "some.lock", waits.set):
        assert not waits.is_set()


def test_it_can_be_tried_without_waiting(tmp_path: Path) -> None:
    first, second = (Lock(tmp_path / "folder" / "some.lock") for _ in range(2))
    assert first.take()
    assert not second.take()
    first.release()
    assert second.take()


def test_where_no_lock_can_be_had_everyone_has_it(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with locked(tmp_path / "file" / "some.lock"), locked(tmp_path / "file" / "some.lock"):
        pass
