"""The container engine of this machine: Docker or Podman, depending on which works."""

import asyncio
import contextlib
import functools
import io
import json
import os
import shutil
import subprocess
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from pathlib import Path
from typing import Any

from wildscav.errors import UserError
from wildscav_evaluator.sandbox.base import SandboxError
from wildscav_evaluator.sandbox.processes import all_processes, read_file

ENGINES = ("podman", "docker")  # in this order: Podman needs no daemon
CHOICE = "WILDSCAV_ENGINE"  # the environment variable that names the engine to use
COMMAND_TIMEOUT = 120.0  # s for a command of the engine to finish
OWNER = "wildscav.owner"  # label of containers with their owner, as `wildscav_server.leftovers` names it
BARE = "localhost/wildscav-bare"  # an empty image, for agents that run with this machine's Python
INSTALL = "install Podman (packages podman, runc, catatonit, uidmap) or Docker"
LONGEST = 300  # characters of an error message that are shown


@dataclass(frozen=True)
class ContainerEngine:
    """A container engine, and the options that it needs on this machine."""

    name: str
    options: tuple[str, ...] = field(default=())
    all_users: bool = False  # whether each container may run as a user of its own

    @property
    def command(self) -> tuple[str, ...]:
        """The first arguments of every command of the engine."""
        return (self.name, *self.options)

    async def run(self, *arguments: str, environment: Mapping[str, str] | None = None) -> str:
        """Run a command of the engine and return what it prints; SandboxError if it failed."""
        process = await asyncio.create_subprocess_exec(
            *self.command,
            *arguments,
            env=None if environment is None else dict(environment),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
        )
        try:
            async with asyncio.timeout(COMMAND_TIMEOUT):
                output, errors = await process.communicate()
        except TimeoutError:
            process.kill()
            raise SandboxError(f"{self.name} {arguments[0]} takes more than {COMMAND_TIMEOUT:g} s") from None
        if process.returncode != 0:
            raise SandboxError(f"{self.name} {arguments[0]} failed: {last_line(errors)}")
        return output.decode("utf-8", "replace").strip()


def last_line(output: bytes) -> str:
    """Return the last line that is not empty, shortened if it is too long."""
    lines = output.decode("utf-8", "replace").splitlines()
    line = next((line.strip() for line in reversed(lines) if line.strip()), "no message")
    return line if len(line) <= LONGEST else f"{line[:LONGEST]} …"


def find_engine() -> ContainerEngine:
    """Return the engine that works on this machine, or the one that WILDSCAV_ENGINE names.

    SandboxError, which says what each lacks, if none works.
    """
    return _find(*(os.environ.get(name, "") for name in (CHOICE, "DOCKER_HOST", "PATH")))


@functools.cache
def _find(asked: str, docker_host: str, path: str) -> ContainerEngine:
    del path  # part of the cache's key only: it decides which programs are found
    if asked and asked not in ENGINES:
        raise SandboxError(f"{CHOICE} is {asked!r}, must be one of {', '.join(ENGINES)}")
    reasons = []
    for name in (asked,) if asked else ENGINES:
        if shutil.which(name) is None:
            reasons.append(f"{name} is not installed")
            continue
        try:
            return _podman() if name == "podman" else _docker(docker_host)
        except SandboxError as error:
            reasons.append(f"{name}: {error}")
    raise SandboxError(f"no container engine works here ({'; '.join(reasons)}): {INSTALL}")


def _podman() -> ContainerEngine:
    # crun does not support control groups of version 1; runc does.
    options = ("--runtime", "runc") if has_cgroup_v1() and shutil.which("runc") else ()
    engine = ContainerEngine("podman", options, all_users=os.getuid() == 0)
    _ask(engine, "version", "--format", "{{.Version}}")
    return engine


def _docker(host: str) -> ContainerEngine:
    engine = ContainerEngine("docker", ("--host", host) if host else ())
    server = _ask(engine, "version", "--format", "{{json .Server}}")
    if any("podman" in str(part.get("Name", "")).lower() for part in server.get("Components") or ()):
        raise SandboxError(
            "its daemon is Podman, which ignores filters of system calls set by docker: use podman itself"
        )
    security = _ask(engine, "info", "--format", "{{json .SecurityOptions}}") or ()
    return replace(engine, all_users=not any("rootless" in one or "userns" in one for one in security))


def _ask(engine: ContainerEngine, *arguments: str) -> Any:
    """Return the output of an engine's command, parsed if it is JSON."""
    answer = call(engine, *arguments)
    if answer.returncode != 0:
        raise SandboxError(last_line(answer.stderr))
    with contextlib.suppress(ValueError):
        return json.loads(answer.stdout)
    return answer.stdout


def has_cgroup_v1() -> bool:
    """Return whether this machine has control groups of version 1."""
    return not Path("/sys/fs/cgroup/cgroup.controllers").exists()


def call(
    engine: ContainerEngine, *arguments: str, content: bytes | None = None
) -> "subprocess.CompletedProcess[bytes]":
    """Run a command of the engine and wait for it; SandboxError if it takes too long."""
    try:
        return subprocess.run(
            [*engine.command, *arguments],
            input=content,
            stdin=subprocess.DEVNULL if content is None else None,
            capture_output=True,
            check=False,
            timeout=COMMAND_TIMEOUT,
        )
    except subprocess.TimeoutExpired:
        raise SandboxError(f"{engine.name} {arguments[0]} takes more than {COMMAND_TIMEOUT:g} s") from None


@functools.cache
def bare_image(engine: ContainerEngine, folders: Sequence[str], links: tuple[tuple[str, str], ...]) -> str:
    """Return an image with only empty folders and links, which is created if it does not exist."""
    content = io.BytesIO()
    with tarfile.open(fileobj=content, mode="w") as archive:
        for path in folders:
            entry = tarfile.TarInfo(path.lstrip("/"))
            entry.type, entry.mode = tarfile.DIRTYPE, 0o1777 if path == "/tmp" else 0o755  # noqa: S108
            archive.addfile(entry)
        for path, target in links:
            entry = tarfile.TarInfo(path.lstrip("/"))
            entry.type, entry.linkname = tarfile.SYMTYPE, target
            archive.addfile(entry)
    name = f"{BARE}:{blake2b(content.getvalue(), digest_size=8).hexdigest()}"
    if call(engine, "image", "inspect", name).returncode == 0:
        return name
    imported = call(engine, "import", "-", name, content=content.getvalue())
    if imported.returncode != 0:
        raise SandboxError(f"{engine.name} cannot make an image: {last_line(imported.stderr)}")
    return name


@functools.cache
def image_command(engine: ContainerEngine, image: str) -> tuple[str, ...]:
    """Return the command that an image runs by default; UserError if it has none."""
    settings = image_settings(engine, image)
    command = (*(settings.get("Entrypoint") or ()), *(settings.get("Cmd") or ()))
    if not command:
        raise UserError(f"image {image} has no command: it needs an ENTRYPOINT or a CMD")
    return command


def image_settings(engine: ContainerEngine, image: str) -> dict[str, Any]:
    """Return the settings with which an image is run."""
    settings: dict[str, Any] = _ask(engine, "image", "inspect", "--format", "{{json .Config}}", image)
    return settings


def processes_of(identity: str) -> list[int]:
    """Return the processes of a container on this machine, by the names of their control groups."""
    return [process for process in all_processes() if is_in_container(process, identity)]


def is_in_container(process: int, identity: str) -> bool:
    """Return whether a process of this machine is one of a container."""
    groups = read_file(process, "cgroup")
    # Podman's monitor of a container is also in a group that is named after it.
    return identity.encode() in groups and f"conmon-{identity}".encode() not in groups
