"""A probe that tries what an agent can do in a sandbox, and prints the findings as JSON.

It runs as an agent, to find out whether a sandbox keeps its promises. Nothing in it does harm if it succeeds.
"""

import contextlib
import ctypes
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ORDERS: dict[str, Any] = json.loads(Path("orders.json").read_text("utf-8"))
NEW_USER = 0x1000_0000
BURN = 0.3  # s of computing, to measure processor time
MEBIBYTE = 1 << 20
WRITABLE = ("/", "/tmp", "/dev", "/dev/shm", "/var/tmp", "/run", "/usr", "/etc", "/home", "/proc", "/sys")


def status(name: str) -> str:
    """Return a field of the kernel's status of this process."""
    for line in Path("/proc/self/status").read_text("ascii").splitlines():
        if line.startswith(f"{name}:"):
            return line.partition(":")[2].strip()
    return ""


def refused(function: str, *arguments: object) -> str:
    """Call a function of the C library in a child; return why it was refused, or an empty text."""
    child = os.fork()
    if child == 0:
        library = ctypes.CDLL(None, use_errno=True)
        os._exit(ctypes.get_errno() if getattr(library, function)(*arguments) == -1 else 0)
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return os.strerror(code) if code > 0 else ""


def writable_places() -> dict[str, int]:
    """Return the folders in which files can be created, with the size of their file systems in bytes."""
    found = {}
    for place in (*WRITABLE, os.getcwd()):
        path = Path(place, f"probe-{os.getpid()}")
        with contextlib.suppress(OSError):
            path.write_text("x", "ascii")
            path.unlink()
            space = os.statvfs(place)
            found[place] = space.f_blocks * space.f_frsize
    return found


def processes_possible(most: int) -> int:
    """Return how many processes can run, including this one; try no more than ``most``."""
    children: list[int] = []
    with contextlib.suppress(OSError):
        while len(children) < most:
            child = os.fork()
            if child == 0:
                time.sleep(30)
                os._exit(0)
            children.append(child)
    for child in children:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    return len(children) + 1


def memory_possible(most: int) -> int:
    """Return how many bytes a process can use before it is killed; try no more than ``most``."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        kept = []
        for count in range(most // MEBIBYTE):
            kept.append(bytearray(b"x") * MEBIBYTE)
            os.write(writer, bytes([count % 256]))
        os._exit(0)
    os.close(writer)
    used = 0
    while chunk := os.read(reader, 65536):
        used += len(chunk)
    os.waitpid(child, 0)
    return used * MEBIBYTE


def cores_possible() -> float:
    """Return how many cores' worth of processor time two processes get."""
    started, before = time.monotonic(), os.times()
    for child in [os.fork() or _burn(started + BURN) for _ in range(2)]:
        os.waitpid(child, 0)
    after = os.times()
    used = after.children_user + after.children_system - before.children_user - before.children_system
    return used / (time.monotonic() - started)


def _burn(until: float) -> int:
    while time.monotonic() < until:
        pass
    os._exit(0)


TRIALS: dict[str, Callable[[], object]] = {
    "user": lambda: [*os.getresuid(), *os.getresgid(), *os.getgroups()],
    "capabilities": lambda: [status(name) for name in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb")],
    "no_new_privileges": lambda: status("NoNewPrivs"),
    "filter": lambda: status("Seccomp"),
    "interfaces": lambda: [line.split(":")[0].strip() for line in _lines("/proc/self/net/dev")[2:]],
    "processes_seen": lambda: [int(entry) for entry in os.listdir("/proc") if entry.isdecimal()],
    "files_seen": lambda: [path for path in ORDERS["hidden"] if Path(path).exists()],
    "namespaces": lambda: refused("unshare", NEW_USER),
    "tracing": lambda: refused("ptrace", 0, 0, None, None),
    "open_files": lambda: resource.getrlimit(resource.RLIMIT_NOFILE)[1],
    "writable": writable_places,
    "cores": cores_possible,
    "processes": lambda: processes_possible(ORDERS["processes"]),
    "memory": lambda: memory_possible(ORDERS["memory"]),
}


def _lines(path: str) -> list[str]:
    return Path(path).read_text("ascii").splitlines()


def main() -> None:
    """Run all trials, print the findings, and then print more than the limit on output."""
    found = {}
    for name, trial in TRIALS.items():
        try:
            found[name] = trial()
        except (OSError, ValueError) as error:
            found[name] = f"{type(error).__name__}: {error}"
    sys.stdout.write(json.dumps(found) + "\n")
    sys.stdout.flush()
    for _ in range(ORDERS["output"] // 1024):
        sys.stdout.write("x" * 1023 + "\n")
    sys.stdout.flush()
    # A child that stays behind, which the sandbox must end.
    if os.fork() == 0:
        os.setsid()
        time.sleep(60)
    os._exit(0)


main()
