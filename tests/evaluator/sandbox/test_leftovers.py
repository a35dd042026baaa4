"""Whoever starts agents may be killed at any moment, with all of its children: the next command tidies up."""

import contextlib
import functools
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox import starter
from tests.evaluator.sandbox.sandbox_runs import GROUPS, folders_of, listening, processes_with, wait_until

from wildscav_evaluator.sandbox import Sandbox
from wildscav_evaluator.sandbox.containers.container_engine import OWNER, call, find_engine
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers

pytestmark = pytest.mark.slow

KILLS = 3  # more are a run by hand


def test_nothing_is_left_of_who_was_killed_at_any_moment(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    marker = f"left-{os.getpid()}-{time.monotonic_ns()}"
    submission = submit("stubborn", code=STUBBORN.format(marker=marker))
    dice = random.Random(7)  # noqa: S311
    with listening(tmp_path / "match.sock") as address:
        for _ in range(int(os.environ.get("WILDSCAV_TEST_KILLS", KILLS))):
            started, owner = start(real, submission, address, tmp_path / "log", "again")
            time.sleep(dice.uniform(0.0, 1.5))
            kill_tree(started)

            # A child that was just being started may outlive the others for a moment, and holds the lock.
            wait_until(functools.partial(is_swept, owner, real))
            wait_until(lambda: not processes_with(marker))


def is_swept(owner: str, sandbox: Sandbox) -> bool:
    """Sweep as the next command does, and return whether nothing of an owner is left."""
    leftovers.sweep()
    return left_of(owner, sandbox) == []


STUBBORN = """
import os, signal, subprocess, sys, time
for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
    signal.signal(number, signal.SIG_IGN)
subprocess.Popen([sys.executable, "-c", "import time; time.sleep(300)", "{marker}"], start_new_session=True)
time.sleep(300)
"""


def test_a_container_ends_by_its_wall_clock_even_if_nobody_watches_it(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    if real.name != "oci":
        pytest.skip("the agents of other sandboxes die with whoever started them")
    marker = f"left-{os.getpid()}-{time.monotonic_ns()}"
    submission, log = submit("stubborn", code=STUBBORN.format(marker=marker)), tmp_path / "log"
    with listening(tmp_path / "match.sock") as address:
        for seconds in (4.0, 16.0, 64.0):
            started, _ = start(real, submission, address, log, str(seconds))
            wait_until(lambda: bool(processes_with(marker)) or started.poll() is not None)  # noqa: B023
            running = bool(processes_with(marker))
            kill_tree(started)
            if running:  # on a busy machine it may have been ended before it came to its first line
                break
        assert running

        wait_until(lambda: not processes_with(marker))

    leftovers.sweep()


def start(
    sandbox: Sandbox, submission: Submission, address: str, log: Path, how: str
) -> "tuple[subprocess.Popen[str], str]":
    """Start a process that starts agents; return it, and its name as an owner."""
    arguments = [sandbox.name, str(submission.folder), address, str(log), how]
    started = subprocess.Popen(
        [sys.executable, starter.__file__, *arguments], stdout=subprocess.PIPE, text=True
    )
    assert started.stdout is not None
    return started, started.stdout.readline().strip()


def kill_tree(started: "subprocess.Popen[str]") -> None:
    """Kill a process and all that it has started, its reaper of containers included."""
    processes = [started.pid, *descendants(started.pid), *reapers(started.pid)]
    for process in processes:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)
    started.communicate()


def descendants(process: int) -> Iterator[int]:
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{process}/task").iterdir():
            for child in (task / "children").read_text().split():
                yield int(child)
                yield from descendants(int(child))


def reapers(process: int) -> list[int]:
    """Return the processes that wait for the end of one, to remove what it leaves."""
    return [reaper for folder in folders_of(process) for reaper in processes_with(f"[ -e {folder}")]


def left_of(owner: str, sandbox: Sandbox) -> list[str]:
    """Return the folders, control groups, containers and monitors of containers that an owner still has."""
    name = f"{leftovers.PREFIX}{owner}"
    folders = [str(path) for path in Path(tempfile.gettempdir()).glob(f"*{owner}*")]
    groups = [str(path) for path in GROUPS.glob(f"**/{name}-*")]
    containers: list[str] = []
    if sandbox.name == "oci":
        listed = call(find_engine(), "ps", "-aq", "--filter", f"label={OWNER}={owner}")
        containers = listed.stdout.decode().split()
    # Podman may have lost a container that its monitor still watches.
    monitors = [f"monitor {process}" for process in processes_with(f"{name}-")]
    return [*folders, *groups, *containers, *monitors]
