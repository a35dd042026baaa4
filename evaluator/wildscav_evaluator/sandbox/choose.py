"""Which sandbox agents run in: the one asked for, or the strongest that keeps its promises here."""

import contextlib
import hashlib
import inspect
import json
import os
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wildscav import __version__
from wildscav_evaluator.cache import cache_folder
from wildscav_evaluator.sandbox.base import Sandbox, SandboxError
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.sandbox.process import WARNING, ProcessSandbox
from wildscav_server import leftovers

BOOT = Path("/proc/sys/kernel/random/boot_id")
ENGINE = ("WILDSCAV_ENGINE", "DOCKER_HOST", "CONTAINER_HOST")  # variables that say who runs containers
OF_LINUX = ("oci", "bubblewrap")  # sandboxes that build on namespaces, control groups and seccomp
PROGRAMS = ("podman", "docker", "runc", "crun", "bwrap", "setpriv")


@dataclass(frozen=True)
class Choice:
    """The sandbox to use, and the warnings to show with it."""

    sandbox: Sandbox
    warnings: tuple[str, ...] = ()


def choose(
    asked: str | None, sandboxes: Sequence[Sandbox], limits: Limits, *, images: bool = False
) -> Choice:
    """Return the sandbox to use, after removing the leftovers of commands that were killed.

    It is the one that is asked for by name, or the first that works of the ``sandboxes``, the strongest
    first. If ``images`` are to run, only containers do. SandboxError says which promises are not kept.
    """
    leftovers.sweep()
    if asked is not None:
        sandbox = next(one for one in sandboxes if one.name == asked)
        why = missing_promises(sandbox, limits)
        if why:
            raise SandboxError(
                f"the sandbox {asked} cannot be kept here: {why}; `wildscav doctor` tells more"
            )
        return Choice(sandbox, (WARNING,) if isinstance(sandbox, ProcessSandbox) else ())
    reasons: list[str] = []
    for sandbox in sandboxes:
        if images and not sandbox.runs_images:
            raise SandboxError(f"a submission is an image, which only containers run: {'; '.join(reasons)}")
        why = missing_promises(sandbox, limits)
        if not why:
            return Choice(sandbox, () if sandbox.isolated else (WARNING, *reasons))
        reasons.append(f"{sandbox.name} does not work here: {why}")
    raise SandboxError("; ".join(reasons))


def missing_promises(sandbox: Sandbox, limits: Limits) -> str:
    """Return which promises a sandbox breaks on this machine, nothing if it keeps all.

    Success is remembered until the machine restarts or a program changes. A limit that cannot be set stops
    every start in any case.
    """
    if not sandbox.isolated:
        return ""
    if sandbox.name in OF_LINUX and sys.platform != "linux":
        return f"it needs Linux, and this system is {sys.platform}"
    memory = _memory(sandbox, limits)
    if memory.exists():
        return ""
    broken = [promise for promise in sandbox.promises(limits) if not promise.kept]
    if not broken:
        with contextlib.suppress(OSError):
            memory.parent.mkdir(parents=True, exist_ok=True)
            memory.touch()
    reasons = (f"{one.name}: {one.found}" + (f" ({one.remedy})" if one.remedy else "") for one in broken)
    return "; ".join(reasons)


def _memory(sandbox: Sandbox, limits: Limits) -> Path:
    """Return the file that exists if the sandbox kept all promises under the present circumstances."""
    places = [shutil.which(name) or "" for name in PROGRAMS]
    facts = [
        sandbox.name,
        __version__,
        BOOT.read_text("ascii") if BOOT.exists() else "",
        os.getuid(),
        sys.executable,
        [os.environ.get(name, "") for name in ENGINE],
        limits.model_dump_json(),
        [(place, os.stat(place).st_mtime if place else 0) for place in places],  # noqa: PTH116
        sorted((str(path), path.stat().st_mtime) for path in Path(__file__).parent.rglob("*.py")),
        Path(inspect.getfile(type(sandbox))).stat().st_mtime,  # of one that a package adds
    ]
    digest = hashlib.blake2b(json.dumps(facts).encode(), digest_size=16).hexdigest()
    return cache_folder("sandboxes") / digest
