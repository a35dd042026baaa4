"""The container engine of this machine: Docker or Podman, whichever works."""

import asyncio
import functools
import io
import os
import shutil
import subprocess
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from wildscav_evaluator.sandbox.base import SandboxError

ENGINES = ("podman", "docker")  # in this order: Podman needs no daemon
PATIENCE = 120.0  # s for a command that makes, removes or looks up something
OWNER = "wildscav.owner"  # label of containers: the process that started them
BARE = "localhost/wildscav-bare"  # an image of nothing, for agents that run with this machine's Python
INSTALL = "install Podman (packages podman, runc, catatonit, uidmap) or Docker"


@dataclass(frozen=True)
class Engine:
    """A container engine, and what it needs on this machine."""

    name: str
    options: tuple[str, ...] = field(default=())

    async def run(self, *arguments: str, environment: Mapping[str, str] | None = None) -> str:
        """Run a command of the engine and return what it prints.

        Raises:
            SandboxError: It failed; says how.
        """
        process = await asyncio.create_subprocess_exec(
            self.name,
            *self.options,
            *arguments,
            env=None if environment is None else dict(environment),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,
        )
        try:
            async with asyncio.timeout(PATIENCE):
                output, complaints = await process.communicate()
        except TimeoutError:
            process.kill()
            raise SandboxError(f"{self.name} {arguments[0]} takes more than {PATIENCE:g} s") from None
        if process.returncode != 0:
            raise SandboxError(f"{self.name} {arguments[0]} failed: {last_line(complaints)}")
        return output.decode("utf-8", "replace").strip()


def last_line(output: bytes) -> str:
    """Return the last line that is not empty."""
    lines = output.decode("utf-8", "replace").splitlines()
    return next((line.strip() for line in reversed(lines) if line.strip()), "without a word")


@functools.cache
def find_engine() -> Engine:
    """Return the engine that works on this machine.

    Raises:
        SandboxError: None does; says what each lacks.
    """
    complaints = []
    for name in ENGINES:
        if shutil.which(name) is None:
            complaints.append(f"{name} is not installed")
            continue
        engine = Engine(name, _options(name))
        found = call(
            engine, "version", "--format", "{{.Server.Version}}" if name == "docker" else "{{.Version}}"
        )
        if found.returncode == 0:
            return engine
        complaints.append(f"{name}: {last_line(found.stderr)}")
    raise SandboxError(f"no container engine works here ({'; '.join(complaints)}): {INSTALL}")


def _options(name: str) -> tuple[str, ...]:
    # crun cannot work with control groups of version 1, which runc can.
    return ("--runtime", "runc") if name == "podman" and old_groups() and shutil.which("runc") else ()


def old_groups() -> bool:
    """Return whether this machine has control groups of version 1."""
    return not Path("/sys/fs/cgroup/cgroup.controllers").exists()


def call(
    engine: Engine, *arguments: str, content: bytes | None = None
) -> "subprocess.CompletedProcess[bytes]":
    """Run a command of the engine and wait for it.

    Raises:
        SandboxError: It takes too long.
    """
    try:
        return subprocess.run(
            [engine.name, *engine.options, *arguments],
            input=content,
            stdin=subprocess.DEVNULL if content is None else None,
            capture_output=True,
            check=False,
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        raise SandboxError(f"{engine.name} {arguments[0]} takes more than {PATIENCE:g} s") from None


@functools.cache
def bare_image(engine: Engine, folders: Sequence[str], links: tuple[tuple[str, str], ...]) -> str:
    """Return an image of empty folders and links, made if it is not there yet.

    Raises:
        SandboxError: It could not be made.
    """
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
    name = f"{BARE}:{_digest(content.getvalue())}"
    if call(engine, "image", "inspect", name).returncode == 0:
        return name
    imported = call(engine, "import", "-", name, content=content.getvalue())
    if imported.returncode != 0:
        raise SandboxError(f"{engine.name} cannot make an image: {last_line(imported.stderr)}")
    return name


def _digest(content: bytes) -> str:
    import hashlib

    return hashlib.blake2b(content, digest_size=8).hexdigest()


@functools.cache
def owner(engine: Engine, process: int) -> str:
    """Return the label of the containers of a process, and see to it that they end when it does.

    Containers belong to the engine: they would outlive a process that was killed. So another waits for its
    end and then removes them. That one must be in a session of its own, or it would be killed with it.

    Args:
        engine: Which runs the containers.
        process: This one.
    """
    label = f"{OWNER}={process}"
    command = " ".join((engine.name, *engine.options))
    script = f"cat; cd /; {command} ps -aq --filter label={label} | xargs -r {command} rm -f"
    reading, _ = os.pipe()  # the other end stays open as long as this process lives
    quiet = [(os.POSIX_SPAWN_OPEN, output, os.devnull, os.O_WRONLY, 0) for output in (1, 2)]
    files = [(os.POSIX_SPAWN_DUP2, reading, 0), *quiet]
    os.posix_spawn("/bin/sh", ["sh", "-c", script], os.environ, file_actions=files, setsid=True)
    os.close(reading)
    return label
