"""The plain process: what an agent gets, what is kept of it, and that nothing of it stays behind."""

import asyncio
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox import starter
from tests.evaluator.sandbox.sandbox_runs import run_agent, wait_until

from wildscav_evaluator.matches.play import launch_for
from wildscav_evaluator.sandbox import SANDBOXES, Ending, Limits
from wildscav_evaluator.sandbox.process import kill_session
from wildscav_evaluator.submissions.submission import Submission

PROCESS = SANDBOXES["process"]


def run_to_end(submission: Submission, folder: Path, lasts: float = 60.0, **options: Any) -> Ending:
    limits = Limits.model_validate({"output": options.pop("output", 1_000_000)})
    return run_agent(PROCESS, submission, folder, limits, lasts=lasts, **options)[0]


def test_an_agent_that_does_not_import_says_so_in_its_last_words(submit: Submit, tmp_path: Path) -> None:
    submission = submit("broken", code="import no_such_module")

    ending = run_to_end(submission, tmp_path)

    assert ending.exit_code == 3
    assert (
        ending.last_words == "ModuleNotFoundError: No module named 'no_such_module' (agent.py:1, in <module>)"
    )
    assert str(ending) == f"the agent's process ended (exit code 3): {ending.last_words}"
    assert "import no_such_module" in "".join(ending.last_lines)
    assert "agent.py" in (tmp_path / "log").read_text()


def test_an_agent_sees_nothing_of_the_users_environment(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AWS_SECRET", "hands off")
    monkeypatch.setenv("PYTHONPATH", "/somewhere")
    submission = submit("curious", code="import os\nprint(sorted(os.environ))\nprint(os.getcwd())")

    run_to_end(submission, tmp_path)

    log = (tmp_path / "log").read_text()
    assert "WILDSCAV_TOKEN" in log
    assert "OMP_NUM_THREADS" in log
    assert "AWS_SECRET" not in log
    assert "PYTHONPATH" not in log
    assert str(submission.folder) in log


@pytest.mark.parametrize("limit", [4096, 50_000, 1_000_000])
def test_a_log_is_cut_at_its_limit_and_the_agent_never_blocks(
    submit: Submit, tmp_path: Path, limit: int
) -> None:
    submission = submit("talkative", code="print('x' * 3_000_000)")

    ending = run_to_end(submission, tmp_path, output=limit)

    assert (tmp_path / "log").read_bytes() == b"x" * limit + b"\n[the log is cut here]\n"
    assert ending.exit_code is not None


def test_an_agent_ends_with_its_wall_clock(submit: Submit, tmp_path: Path) -> None:
    submission = submit("sleeper", code="import time\nprint('good night', flush=True)\ntime.sleep(600)")

    ending = run_to_end(submission, tmp_path, lasts=1.0)

    assert ending.limit == "wall clock"
    assert "its wall clock is used up" in str(ending)


def test_a_log_that_cannot_be_written_costs_the_log_alone(submit: Submit, tmp_path: Path) -> None:
    submission = submit("plain", code="print('hello')")

    assert run_to_end(submission, tmp_path, log=Path("/dev/full")).exit_code is not None


CHILDREN = """
import os, subprocess, sys, time
child = [sys.executable, "-c", "import time; time.sleep(600)"]
print(subprocess.Popen(child).pid)
print(subprocess.Popen(child, process_group=0).pid)
print(os.getpid(), flush=True)
time.sleep(600)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other process groups are found by Linux's /proc")
def test_stopping_an_agent_ends_all_that_it_started(submit: Submit, tmp_path: Path) -> None:
    submission, log = submit("parent", code=CHILDREN), tmp_path / "log"

    async def run() -> list[int]:
        agent = await PROCESS.start(launch_for(submission, "unix:/nowhere", "of the seat", log))
        await asyncio.to_thread(wait_until, lambda: lines(log) >= 3)
        await agent.stop()
        await agent.stop()
        return [int(word) for word in log.read_text().split()]

    pids = asyncio.run(run())

    assert len(pids) == 3
    assert [pid for pid in pids if running(pid)] == []


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel's word for it is Linux's")
def test_an_agent_ends_when_whoever_started_it_is_killed(submit: Submit, tmp_path: Path) -> None:
    submission, log = submit("orphan", code=CHILDREN), tmp_path / "log"
    arguments = ("process", str(submission.folder), "unix:/nowhere", str(log))
    started = subprocess.Popen([sys.executable, starter.__file__, *arguments], stdout=subprocess.DEVNULL)
    wait_until(lambda: lines(log) >= 3)
    agent = int(log.read_text().split()[-1])

    started.kill()
    started.wait()

    wait_until(lambda: not running(agent))
    for child in log.read_text().split()[:2]:
        os.kill(int(child), signal.SIGKILL)


# An agent ends, a stranger gets its number, and then the agent is stopped. It runs in a namespace of process
# numbers, in which it may choose the next one.
REUSER = """
import asyncio, subprocess, sys
from pathlib import Path
from wildscav_evaluator.sandbox import SANDBOXES, Launch

async def run():
    launch = Launch(Path(sys.argv[1]), "agent:Player", "unix:/nowhere", "of the seat", Path(sys.argv[2]))
    agent = await SANDBOXES["process"].start(launch)
    await agent.ended()
    Path("/proc/sys/kernel/ns_last_pid").write_text(str(agent.pid - 1))
    stranger = subprocess.Popen(["sleep", "100"], start_new_session=True)
    assert stranger.pid == agent.pid
    await agent.stop()
    assert stranger.poll() is None

asyncio.run(run())
"""
UNSHARE = ("unshare", "--pid", "--fork", "--mount-proc")


def test_stopping_an_agent_that_has_ended_spares_whoever_got_its_number(
    submit: Submit, tmp_path: Path
) -> None:
    if shutil.which("unshare") is None or subprocess.call([*UNSHARE, "true"]):
        pytest.skip("it takes Linux and root")
    submission = submit("short", code="")

    subprocess.run([*UNSHARE, sys.executable, "-c", REUSER, submission.folder, tmp_path / "log"], check=True)


@pytest.mark.skipif(sys.platform != "linux", reason="pidfds are Linux's")
def test_a_session_whose_number_is_a_strangers_by_now_is_spared() -> None:
    ours, stranger = (subprocess.Popen(["sleep", "100"], start_new_session=True) for _ in range(2))
    leaders = [os.pidfd_open(process.pid) for process in (ours, stranger)]
    ours.kill()
    ours.wait()

    assert kill_session(stranger.pid, leaders[0])
    assert stranger.poll() is None
    assert kill_session(stranger.pid, leaders[1])
    assert stranger.wait() == -signal.SIGKILL
    for leader in leaders:
        os.close(leader)


def lines(log: Path) -> int:
    return log.read_text().count("\n") if log.exists() else 0


def running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize(
    ("code", "signal_name"),
    [
        ("os._exit(255)", ""),
        ("os._exit(192)", "SIGRTMAX"),
        ("os._exit(139)", "SIGSEGV"),
        ("os._exit(128)", ""),
        ("os.kill(os.getpid(), 9)", "SIGKILL"),
    ],
)
def test_only_what_is_a_signal_is_told_as_one(
    submit: Submit, tmp_path: Path, code: str, signal_name: str
) -> None:
    ending = run_to_end(submit("ending", code=f"import os\n{code}"), tmp_path)

    assert ending.killed_by == signal_name
    assert (ending.exit_code is None) == bool(signal_name)
    assert f"killed by {signal_name}" in str(ending) or not signal_name


def test_a_long_line_is_told_in_whole_words(submit: Submit, tmp_path: Path) -> None:
    ending = run_to_end(submit("wordy", code="print('wonderful ' * 50)"), tmp_path)

    assert ending.last_lines[0] == " ".join(["wonderful"] * 20) + " …"
