"""Worker processes end with who started them."""

import signal
import subprocess
import sys
from pathlib import Path

KILLED = """
import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from wildscav.system.worker_processes import end_with_parent

if __name__ == "__main__":
    pool = ProcessPoolExecutor(2, get_context("spawn"), end_with_parent, (os.getpid(),))
    for job in [pool.submit(os.getpid) for _ in range(4)]:
        print(job.result(), flush=True)
    os.kill(os.getpid(), 9)
"""


def run_script(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a script to its end, and that of all workers that it started: they hold its output open."""
    script = folder / "script.py"
    script.write_text(code)
    return subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300)


def test_workers_end_with_a_command_that_is_killed(tmp_path: Path) -> None:
    done = run_script(KILLED, tmp_path)
    assert done.returncode == -9
    assert len(done.stdout.split()) == 4


HUNG = """
import os, signal, time
from multiprocessing import get_context
from wildscav.system import worker_processes

def hang(parent, connection):
    worker_processes.GRACE = 0.5
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    worker_processes.end_with_parent(parent)
    connection.send("hung")
    time.sleep(600)

if __name__ == "__main__":
    ours, theirs = get_context("spawn").Pipe()
    get_context("spawn").Process(target=hang, args=(os.getpid(), theirs)).start()
    print(ours.recv(), flush=True)
    os.kill(os.getpid(), 9)
"""


def test_a_worker_that_does_not_end_in_good_order_is_killed(tmp_path: Path) -> None:
    done = run_script(HUNG, tmp_path)
    assert done.stdout == "hung\n"


def test_a_worker_whose_parent_is_gone_before_it_began_ends_at_once() -> None:
    code = "import os; from wildscav.system.worker_processes import end_with_parent; end_with_parent({})"

    with_parent = [sys.executable, "-c", code.format("os.getppid()")]
    without = [sys.executable, "-c", code.format("os.getppid() + 1")]

    assert subprocess.run(with_parent).returncode == 0
    assert subprocess.run(without).returncode == 128 + signal.SIGTERM


INTERRUPTED = """
import os, signal, sys, time
from multiprocessing import get_context
from wildscav.system.worker_processes import become_worker, starting_workers

def work(parent, connection):
    become_worker(parent)
    connection.send("ready")
    time.sleep(0.5)  # in which Ctrl-C would end it
    connection.send("done")

if __name__ == "__main__":
    ours, theirs = get_context("spawn").Pipe()
    with starting_workers():
        get_context("spawn").Process(target=work, args=(os.getpid(), theirs)).start()
    signal.signal(signal.SIGINT, lambda *_: None)
    for wait in (lambda: None, ours.recv):  # at once, while it imports; and when it is at work
        wait()
        os.killpg(0, signal.SIGINT)
    print(ours.recv())
"""


def test_ctrl_c_reaches_no_worker_at_any_moment(tmp_path: Path) -> None:
    script = tmp_path / "interrupted.py"
    script.write_text(INTERRUPTED)
    command = [sys.executable, script]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, start_new_session=True)
    assert (done.stdout, done.stderr) == ("done\n", "")
