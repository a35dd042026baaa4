"""What is left of containers when whoever started them is killed, and its removal by the next command."""

import functools
import json
import os
import re
import shlex
import subprocess
import sys
import time
from collections.abc import Iterator

from wildscav_evaluator.sandbox.base import SandboxError
from wildscav_evaluator.sandbox.containers.container_engine import (
    COMMAND_TIMEOUT,
    ContainerEngine,
    call,
    is_in_container,
    last_line,
    processes_of,
)
from wildscav_evaluator.sandbox.processes import all_processes, kill, read_file
from wildscav_server import leftovers

CONTAINER, PROCESSES = "container", "processes of a container"  # kinds in the lists of owners
NOT_THERE = re.compile(rb"no such container|no container with", re.IGNORECASE)
UNDER_WAY = re.compile(rb"removal of container .* is already in progress")
CREATION_TIME = 20.0  # s that creating a container may take
SETTLING = 2.0  # s in which Docker's daemon may still create what a killed command requested
DYING_TIME = 20.0  # s in which killed processes are gone


def enter_container(engine: ContainerEngine, name: str) -> None:
    """Enter a container in this process's list of leftovers, before it is created."""
    leftovers.claim(CONTAINER, _entry(engine, name))


def enter_processes(engine: ContainerEngine, identity: str) -> None:
    """Enter the processes of a created container in that list, before it is started."""
    if engine.name == "podman":  # no command can take a container away from Docker's daemon
        leftovers.claim(PROCESSES, _entry(engine, identity))


def release_container(engine: ContainerEngine, name: str, identity: str = "") -> None:
    """Remove a container that is gone from that list, and its processes if they were entered."""
    leftovers.release(CONTAINER, _entry(engine, name))
    if identity and engine.name == "podman":
        leftovers.release(PROCESSES, _entry(engine, identity))


def _entry(engine: ContainerEngine, name: str) -> str:
    return json.dumps([engine.name, *engine.options, name])


def removal(engine: ContainerEngine, name: str) -> tuple[str, ...]:
    """Return the arguments that remove a container, running or not, with the volumes made for it."""
    return ("rm", "-f", "-v", *(("-t", "0") if engine.name == "podman" else ()), name)


def remove_left_container(entry: str) -> None:
    """Remove a container that was entered in the list of a dead owner; OSError if it may still exist."""
    engine, name = _engine_and_name(entry)
    _wait_for_creation(name)
    now = time.monotonic()
    settled, end = now + (SETTLING if engine.name == "docker" else 0.0), now + COMMAND_TIMEOUT
    while not _is_removed(engine, name, settled):
        if time.monotonic() > end:
            raise OSError(f"{engine.name} could not remove {name}")
        time.sleep(0.1)


def _engine_and_name(entry: str) -> tuple[ContainerEngine, str]:
    command, *options, name = json.loads(entry)
    return ContainerEngine(command, tuple(options)), name


def _is_removed(engine: ContainerEngine, name: str, settled: float) -> bool:
    """Remove a container, and return whether it is gone for good; OSError if it cannot be removed.

    Until it is ``settled``, by the monotonic clock, a missing container may still be created.
    """
    try:
        removed = call(engine, *removal(engine, name))
    except SandboxError as error:
        raise OSError(str(error)) from None
    if removed.returncode == 0:
        # Newer versions of Docker do not complain about missing containers.
        return bool(removed.stdout.strip()) or time.monotonic() >= settled
    if NOT_THERE.search(removed.stderr):
        return time.monotonic() >= settled
    if UNDER_WAY.search(removed.stderr):
        return False
    raise OSError(last_line(removed.stderr))


def _wait_for_creation(name: str) -> None:
    """Wait for an engine's command that is still creating a container although its starter is dead."""
    end = time.monotonic() + CREATION_TIME
    while any(b"create" in words and name.encode() in words for words in _command_lines()):
        if time.monotonic() >= end:
            return
        time.sleep(0.02)


def kill_left_processes(entry: str) -> None:
    """Kill the processes of a removed container whose owner is dead.

    If ``podman start`` is killed before it has noted that the container runs, Podman removes the container
    but leaves its processes running. The OCI runtime still knows them. Podman's monitor ends with them.
    OSError if some may still run.
    """
    engine, identity = _engine_and_name(entry)
    end, delete = time.monotonic() + DYING_TIME, _deletion(engine, identity)
    # The monitor may still be creating processes.
    while not _succeeds(delete) or processes_of(identity) or _is_monitored(identity):
        if time.monotonic() > end:
            raise OSError(f"processes of container {identity} could not be killed")
        for process in processes_of(identity):
            kill(process, lambda process: is_in_container(process, identity))
        time.sleep(0.05)


def _deletion(engine: ContainerEngine, identity: str) -> list[str]:
    """Return the command by which the OCI runtime kills and forgets a container."""
    # Without root, containers live in a namespace of users that only Podman can enter.
    prefix = () if os.getuid() == 0 else (*engine.command, "unshare")
    try:
        runtime = call(engine, "info", "--format", "{{.Host.OCIRuntime.Path}}").stdout.decode().strip()
    except SandboxError as error:
        raise OSError(str(error)) from None
    return [*prefix, runtime, "delete", "--force", identity]


def _succeeds(command: list[str]) -> bool:
    """Run a command, and return whether it succeeds; OSError if it cannot be run, or takes too long."""
    try:
        return (
            subprocess.run(command, capture_output=True, check=False, timeout=COMMAND_TIMEOUT).returncode == 0
        )
    except subprocess.TimeoutExpired as error:
        raise OSError(str(error)) from None


def _is_monitored(identity: str) -> bool:
    """Return whether Podman's monitor of a container still runs."""
    return any(words[0].endswith(b"conmon") and identity.encode() in words for words in _command_lines())


def _command_lines() -> Iterator[list[bytes]]:
    """Return the words of the commands of all processes on this machine."""
    for process in all_processes():
        yield read_file(process, "cmdline").split(b"\0")


leftovers.register(CONTAINER, remove_left_container)
leftovers.register(PROCESSES, kill_left_processes)


@functools.cache
def start_reaper(process: int) -> None:
    """Start a process that waits for the end of this one, and removes what it leaves behind if it is killed.

    Containers belong to the engine, so they would outlive a killed process until the next command. The reaper
    is in its own session and not a child of this process, so that it is not killed together with it. The
    cache starts one reaper for each ``process``, which is the number of this one.
    """
    del process
    program = "import wildscav_evaluator.sandbox; from wildscav_server import leftovers; leftovers.sweep()"
    sweep = [sys.executable, "-c", program]
    after = f"cat <&3; cd /; [ -e {shlex.quote(str(leftovers.own_folder()))} ] && exec {shlex.join(sweep)}"
    reading, _ = os.pipe()  # the writing end stays open as long as this process lives
    quiet = [(os.POSIX_SPAWN_OPEN, output, os.devnull, os.O_WRONLY, 0) for output in (1, 2)]
    files = [(os.POSIX_SPAWN_DUP2, reading, 0), *quiet]
    command = ["sh", "-c", f"exec 3<&0; ({after}) &"]
    shell = os.posix_spawn("/bin/sh", command, os.environ, file_actions=files, setsid=True)
    os.close(reading)
    os.waitpid(shell, 0)
