"""The wall clock of a container, enforced even if everything outside the container is killed.

Podman has an option for it, which its monitor of the container enforces. Docker has none. There the first
process of the container is ``timeout`` from this machine's coreutils, started by this machine's loader, since
an image may have neither. The kernel protects the first process of a namespace from signals of the others, so
no agent can stop it; when it ends, the kernel kills all the others. Variables of an image that control the
loader, such as LD_PRELOAD, could replace the guard with the image's code. So the guard runs without them, and
a program of this machine restores them for the command.
"""

import functools
import math
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from wildscav_evaluator.sandbox.agents.host_python import SOCKET
from wildscav_evaluator.sandbox.base import SandboxError

LATER = 5.0  # s after our own wall clock, which should act first because it can report the cause
GUARD = SOCKET.parent / "guard"  # the folder of the guard's programs in a container
INIT_PLACES = ("/usr/libexec/docker", "/usr/local/bin", "/usr/bin")  # of Docker's init, besides the PATH
LIBRARY = re.compile(r"(/\S+) \(0x")  # in the output of ldd
# Variables that make the loader and the C library take code or data from elsewhere.
STEERING = re.compile(r"(LD|LC|MALLOC)_\w*|GCONV_PATH|GLIBC_TUNABLES|LANG(UAGE)?|LOCPATH|NLSPATH")


def podman_options(seconds: float) -> list[str]:
    """Return the options that end a container of Podman after a time, s."""
    return ["--init", "--timeout", str(math.ceil(seconds + LATER))]


def guard_files() -> Mapping[Path, Path]:
    """Return the files that a guarded container of Docker needs, by their path in the container."""
    timeout, env, init = shutil.which("timeout"), shutil.which("env"), _find_init()
    if timeout is None or env is None or init is None:
        missing = "docker-init (package tini)" if init is None else "timeout or env (package coreutils)"
        raise SandboxError(f"the wall clock cannot be kept in a container of Docker: there is no {missing}")
    programs = {"timeout": Path(timeout), "env": Path(env), "init": init}
    libraries = _libraries(timeout) | _libraries(env)
    if not any(map(_is_loader, libraries)):
        raise SandboxError(
            f"the wall clock cannot be kept in a container of Docker: ldd finds no loader for {timeout}"
        )
    files = programs | libraries
    return {GUARD / name: path.resolve() for name, path in files.items()}


def steering(variables: Sequence[str]) -> list[str]:
    """Return those of an image's variables ("NAME=value") that the guard must not run with."""
    return [variable for variable in variables if STEERING.fullmatch(variable.partition("=")[0])]


def without(variables: Sequence[str]) -> list[str]:
    """Return the options that make variables ("NAME=value") empty for the first process of a container."""
    return [word for variable in variables for word in ("--env", f"{variable.partition('=')[0]}=")]


def guarded(command: Sequence[str], seconds: float, variables: Sequence[str] = ()) -> list[str]:
    """Return a command that Docker runs for some seconds, under an init process that reaps orphans.

    The command gets the variables ("NAME=value"), and the guard does not.
    """
    loader = next(path for path in guard_files() if _is_loader(path.name))
    run = [str(loader), "--library-path", str(GUARD)]
    return [
        *(*run, str(GUARD / "timeout"), "--signal=KILL", str(math.ceil(seconds + LATER))),
        *(str(GUARD / "init"), "-s", "--"),
        *((*run, str(GUARD / "env"), *variables) if variables else ()),
        *command,
    ]


def _is_loader(name: str) -> bool:
    return name.startswith("ld-")


@functools.cache
def _libraries(program: str) -> dict[str, Path]:
    """Return the shared libraries of a program and its loader by name; empty if they are unknown."""
    try:
        listed = subprocess.run(
            ["ldd", program],  # noqa: S607 - its path depends on the system
            capture_output=True,
            text=True,
            check=False,
        ).stdout
    except OSError:  # there is no ldd
        return {}
    return {Path(path).name: Path(path) for path in LIBRARY.findall(listed)}


@functools.cache
def _find_init() -> Path | None:
    path = shutil.which("docker-init")
    candidates = [Path(path)] if path else [Path(place, "docker-init") for place in INIT_PLACES]
    return next((init for init in candidates if init.is_file()), None)
