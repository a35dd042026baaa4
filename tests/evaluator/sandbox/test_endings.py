"""How agents in sandboxes start and end: by themselves, by a limit, with whoever started them."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox import starter
from tests.evaluator.sandbox.sandbox_runs import (
    GROUPS,
    LIMITS,
    folders_of,
    listening,
    processes_with,
    run_agent,
    tight_group,
    wait_until,
)

from wildscav_evaluator.sandbox import Ending, Sandbox
from wildscav_evaluator.sandbox.containers import oci
from wildscav_evaluator.sandbox.containers.container_engine import call, find_engine, has_cgroup_v1
from wildscav_evaluator.sandbox.linux import bubblewrap, cgroup
from wildscav_evaluator.sandbox.linux.kernel_log import logged_kill
from wildscav_evaluator.submissions.submission import Submission

pytestmark = pytest.mark.slow


def run(sandbox: Sandbox, submission: Submission, folder: Path, lasts: float = 60.0) -> tuple[Ending, str]:
    limits = LIMITS.model_copy(update={"cpus": 1.0})
    return run_agent(sandbox, submission, folder, limits, lasts=lasts)


def test_memory_is_what_an_agent_is_said_to_have_died_of(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    greedy = submit("greedy", code="print('more', flush=True)\nbytearray(b'x') * 2**29")

    ending, _ = run(real, greedy, tmp_path)

    assert ending.out_of_memory
    assert str(ending) == "the agent's process ended (out of memory): more"


@pytest.fixture
def short_of_memory(real: Sandbox, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Evaluations have less memory together than one agent may use."""
    memory = LIMITS.memory // 2
    if real.name == "bubblewrap":
        version = cgroup.find_version()
        with tight_group(version.parents["memory"], memory) as group:
            tight = replace(version, parents={**version.parents, "memory": group})
            monkeypatch.setattr(bubblewrap, "find_version", lambda: tight)
            yield
        return
    parent = GROUPS / "memory" if has_cgroup_v1() else GROUPS
    if not os.access(parent, os.W_OK) or group_driver() != "cgroupfs":
        pytest.skip("it takes root, and an engine that makes groups by itself")
    limits = oci._limits
    with tight_group(parent, memory) as group:
        beneath = ["--cgroup-parent", f"/{group.name}"]
        monkeypatch.setattr(oci, "_limits", lambda *given: [*limits(*given), *beneath])
        yield


def group_driver() -> str:
    """Return who makes the engine's control groups."""
    engine = find_engine()
    driver = ".Host.CgroupManager" if engine.name == "podman" else ".CgroupDriver"
    return call(engine, "info", "--format", f"{{{{{driver}}}}}").stdout.decode().strip()


@pytest.mark.usefixtures("short_of_memory")
def test_a_machine_short_of_memory_is_the_platforms_fault(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    within = submit("within", code="print('more', flush=True)\nbytearray(b'x') * (200 * 2**20)")

    ending, _ = run(real, within, tmp_path)

    assert ending.killed_by == "SIGKILL"
    assert not ending.out_of_memory
    assert ending.platform_fault.startswith("this machine is short of memory")


def test_an_agent_that_kills_itself_did_not_die_of_memory(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    without_a_word = real.name == "oci" and find_engine().name == "podman" and has_cgroup_v1()
    unknown = without_a_word and logged_kill("") is None
    code = "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)"

    ending, _ = run(real, submit("ending", code=code), tmp_path)

    assert (ending.killed_by, ending.out_of_memory) == ("SIGKILL", unknown)


@pytest.mark.parametrize(
    ("code", "exit_code", "killed_by"),
    [
        ("import ctypes\nctypes.string_at(0)", None, "SIGSEGV"),
        ("raise ValueError('no reason')", 3, ""),
    ],
)
def test_how_an_agent_ended_is_told_as_it_was(
    real: Sandbox, submit: Submit, tmp_path: Path, code: str, exit_code: int | None, killed_by: str
) -> None:
    ending, _ = run(real, submit("ending", code=code), tmp_path)

    assert (ending.exit_code, ending.killed_by, ending.out_of_memory) == (exit_code, killed_by, False)


def test_the_wall_clock_ends_an_agent(real: Sandbox, submit: Submit, tmp_path: Path) -> None:
    sleeper = submit("sleeper", code="import time\ntime.sleep(3600)")

    ending, _ = run(real, sleeper, tmp_path, lasts=1.5)

    assert ending.limit == "wall clock"


def test_an_agent_finds_its_code_its_socket_and_a_place_for_files(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    code = """
import os, pathlib, socket, tempfile
print(os.getcwd(), pathlib.Path("data.txt").read_text())
tempfile.TemporaryFile().write(b"x")
socket.socket(socket.AF_UNIX).connect(os.environ["WILDSCAV_ADDRESS"].removeprefix("unix:"))
print(os.environ["WILDSCAV_TOKEN"], os.environ["OMP_NUM_THREADS"], os.path.expanduser("~"))
import multiprocessing
print(multiprocessing.Lock().acquire())
import threading
thread = threading.Thread(target=lambda: print("a thread"))
thread.start()
thread.join()
os._exit(0)
"""
    submission = submit("modest", code=code)
    (submission.folder / "data.txt").write_text("of its own")
    (submission.folder / "data.txt").chmod(0o600)  # as an editor may leave it

    ending, log = run(real, submission, tmp_path)

    assert log == "/submission of its own\nof the seat 1 /tmp\nTrue\na thread\n"
    assert ending.exit_code == 0


def test_an_agent_ends_when_whoever_started_it_is_killed(
    real: Sandbox, submit: Submit, tmp_path: Path
) -> None:
    marker = f"orphan-{os.getpid()}-{time.monotonic_ns()}"
    code = f"""
import os, subprocess, sys, time
subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)", {marker!r}], start_new_session=True)
print("ready", flush=True)
time.sleep(60)
"""
    submission, log = submit("orphan", code=code), tmp_path / "log"
    with listening(tmp_path / "match.sock") as address:
        command = [sys.executable, starter.__file__, real.name, submission.folder, address, log]
        started = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL)
        wait_until(lambda: log.exists() and "ready" in log.read_text())
        assert processes_with(marker)

        started.kill()
        started.wait()

        wait_until(lambda: not processes_with(marker))
        wait_until(lambda: not folders_of(started.pid))
