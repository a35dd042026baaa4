"""What a killed process left behind is removed by the next one, and nothing of a live one ever is."""

import fcntl
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from wildscav_server import leftovers

OWNER = """
import sys
from wildscav_server import leftovers
with leftovers.temporary_folder("sockets-") as folder:
    (folder / "match.sock").write_text("x")
    leftovers.claim("lamp", "hall")
    leftovers.claim("lamp", "stairs")
    leftovers.release("lamp", "stairs")
    print(leftovers.own_folder(), flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where owners have their folders: a place of this test's own."""
    with tempfile.TemporaryDirectory() as folder:
        monkeypatch.setenv("TMPDIR", folder)
        monkeypatch.setattr(tempfile, "tempdir", None)
        yield Path(folder)


@pytest.fixture
def lamps(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The things of a kind that were removed."""
    removed: list[str] = []
    monkeypatch.setitem(leftovers._undo, "lamp", removed.append)
    return removed


def start_owner(code: str = OWNER, *arguments: object) -> "tuple[subprocess.Popen[str], Path]":
    command = [sys.executable, "-c", code, *map(str, arguments)]
    owner = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert owner.stdout is not None
    return owner, Path(owner.stdout.readline().strip())


def kill(owner: "subprocess.Popen[str]") -> None:
    owner.kill()
    owner.communicate()


def test_what_a_killed_process_left_is_removed_by_the_next_sweep(place: Path, lamps: list[str]) -> None:
    owner, folder = start_owner()
    assert list(folder.glob("sockets-*/match.sock"))
    leftovers.sweep()
    assert list(folder.glob("sockets-*/match.sock")), "it was alive"

    kill(owner)
    leftovers.sweep()

    assert lamps == ["hall"]
    assert list(place.iterdir()) == []


ELSEWHERE = """
import sys
from pathlib import Path
from wildscav_server import leftovers
with leftovers.temporary_folder_in(Path(sys.argv[1]), ".trial-") as folder:
    (folder / "file").write_text("x")
    print(folder, flush=True)
    sys.stdin.read()
"""


@pytest.mark.parametrize("killed", [True, False])
def test_a_temporary_folder_elsewhere_goes_with_its_process(
    tmp_path: Path, place: Path, killed: bool
) -> None:
    owner, folder = start_owner(ELSEWHERE, tmp_path)
    assert folder.parent == tmp_path
    assert (folder / "file").exists()
    kill(owner) if killed else owner.communicate()
    assert folder.exists() == killed
    leftovers.sweep()
    assert list(tmp_path.iterdir()) == []
    assert not list(place.glob("*wildscav*"))


def test_a_process_that_ends_by_itself_leaves_no_folder(place: Path) -> None:
    owner, folder = start_owner()
    (folder / leftovers.LIST).unlink()  # what it would have removed itself

    owner.communicate("")

    assert not folder.exists()


def test_what_cannot_be_removed_now_is_tried_again(
    place: Path, lamps: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: str) -> None:
        raise OSError("the engine does not answer")

    owner, folder = start_owner()
    kill(owner)
    monkeypatch.setitem(leftovers._undo, "lamp", refuse)
    leftovers.sweep()
    assert folder.exists()

    monkeypatch.setitem(leftovers._undo, "lamp", lamps.append)
    leftovers.sweep()

    assert lamps == ["hall"]
    assert not folder.exists()


def test_things_that_nobody_here_can_remove_wait_for_who_can(place: Path) -> None:
    owner, folder = start_owner()
    kill(owner)

    leftovers.sweep()

    assert folder.exists()


@pytest.mark.parametrize("line", [json.dumps(["lamp", "attic", True])[:-3], "7\n", '[["lamp"], {}, true]\n'])
def test_a_line_that_is_damaged_is_passed_over(place: Path, lamps: list[str], line: str) -> None:
    owner, folder = start_owner()
    kill(owner)
    with (folder / leftovers.LIST).open("a") as file:
        file.write(line)

    leftovers.sweep()

    assert lamps == ["hall"]
    assert not folder.exists()


def test_folders_of_others_are_left_alone(place: Path) -> None:
    other, link = place / "wildscav-other", place / "wildscav-link"
    other.mkdir()
    (other / "file").write_text("not ours: nobody ever locked anything here")
    target = place / "target"
    target.mkdir()
    (target / leftovers.LOCK).touch()
    link.symlink_to(target)

    leftovers.sweep()

    assert (other / "file").exists()
    assert (target / leftovers.LOCK).exists()


def test_a_folder_is_not_removed_before_its_maker_has_had_time_to_lock_it(place: Path) -> None:
    new = place / f"{leftovers.NEW}abc"
    new.mkdir()

    leftovers.sweep()
    assert new.exists()

    os.utime(new, (0, 0))  # its maker was killed long ago
    leftovers.sweep()
    assert not new.exists()


def test_two_sweeps_do_not_get_into_each_others_way(place: Path, lamps: list[str]) -> None:
    owner, folder = start_owner()
    kill(owner)
    other = os.open(folder / leftovers.LOCK, os.O_RDWR)
    fcntl.flock(other, fcntl.LOCK_EX)  # as another sweep has it that is at work

    leftovers.sweep()

    assert lamps == []
    os.close(other)
    leftovers.sweep()
    assert lamps == ["hall"]
