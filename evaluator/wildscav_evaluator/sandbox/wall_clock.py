"""The wall clock of a container, kept even if everything outside of the container is killed.

Podman has an option for it, which its monitor of the container keeps. Docker has none: there the first
process of the container is ``timeout`` of this machine's coreutils, started by this machine's own loader,
since an image may have neither. The kernel keeps the first process of a namespace from signals of the others,
so that no agent can stop it; when it ends, the kernel kills all the others.
"""

import functools
import math
import re
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

from wildscav_evaluator.sandbox.base import SandboxError
from wildscav_evaluator.sandbox.runtime import SOCKET

LATER = 5.0  # s after our own wall clock, which can tell what happened
GUARD = SOCKET.parent / "guard"  # where its programs are in a container
INIT_PLACES = ("/usr/libexec/docker", "/usr/local/bin", "/usr/bin")  # of Docker's init, beside the PATH
LIBRARY = re.compile(r"(/\S+) \(0x")  # in what ldd prints


def podman_options(seconds: float) -> list[str]:
    """Return the options that end a container of Podman after a time, s."""
    return ["--init", "--timeout", str(math.ceil(seconds + LATER))]


def guard_files() -> Mapping[Path, Path]:
    """Return the files that a guarded container of Docker needs: where they are there, and where here.

    Raises:
        SandboxError: This machine does not have them.
    """
    timeout, init = shutil.which("timeout"), _find_init()
    if timeout is None or init is None:
        missing = "timeout (package coreutils)" if timeout is None else "docker-init (package tini)"
        raise SandboxError(f"the wall clock cannot be kept in a container of Docker: there is no {missing}")
    files = {"timeout": Path(timeout), "init": init, **_libraries(timeout)}
    return {GUARD / name: path.resolve() for name, path in files.items()}


def guarded(command: list[str], seconds: float) -> list[str]:
    """Return a command as Docker runs it for a time at most, s, every orphan being buried."""
    loader = next(path for path in guard_files() if path.name.startswith("ld-"))
    timeout = [str(loader), "--library-path", str(GUARD), str(GUARD / "timeout")]
    return [
        *timeout,
        *("--signal=KILL", str(math.ceil(seconds + LATER)), str(GUARD / "init"), "-s", "--"),
        *command,
    ]


@functools.cache
def _libraries(program: str) -> dict[str, Path]:
    """Return the shared libraries of a program, with its loader, by name."""
    listed = subprocess.run(
        ["ldd", program],  # noqa: S607 - wherever the system has it
        capture_output=True,
        text=True,
        check=False,
    ).stdout
    return {Path(path).name: Path(path) for path in LIBRARY.findall(listed)}


@functools.cache
def _find_init() -> Path | None:
    path = shutil.which("docker-init")
    found = [Path(path)] if path else [Path(place, "docker-init") for place in INIT_PLACES]
    return next((init for init in found if init.is_file()), None)
