"""The sandbox that runs agents in containers of Docker or Podman.

An agent runs in the image that it was built into or that it is. If it is a folder without requirements, it
runs in an empty image with this machine's Python. Its limits and promises are those of bubblewrap: see
``docs/security.md``.
"""

import asyncio
import contextlib
import itertools
import json
import os
import resource
import shutil
import signal
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from wildscav_evaluator.sandbox.agents import host_python
from wildscav_evaluator.sandbox.agents.agent_process import (
    SIGNALLED,
    AgentProcess,
    agent_variables,
    python_command,
    start_process,
)
from wildscav_evaluator.sandbox.base import Ending, Launch, MemoryKill, Promise, SandboxError
from wildscav_evaluator.sandbox.containers.container_engine import (
    OWNER,
    ContainerEngine,
    bare_image,
    find_engine,
    has_cgroup_v1,
    image_command,
    image_settings,
    processes_of,
)
from wildscav_evaluator.sandbox.containers.left_containers import (
    enter_container,
    enter_processes,
    release_container,
    removal,
    start_reaper,
)
from wildscav_evaluator.sandbox.containers.wall_clock import (
    GUARD,
    guard_files,
    guarded,
    podman_options,
    steering,
    without,
)
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.sandbox.linux.cgroup import group_of_process, meter_of
from wildscav_evaluator.sandbox.linux.kernel_log import logged_kill
from wildscav_evaluator.sandbox.linux.seccomp import container_profile
from wildscav_evaluator.sandbox.linux.users import agent_user
from wildscav_evaluator.sandbox.processor_waits import GroupMeter
from wildscav_evaluator.submission_files import stage
from wildscav_server import leftovers

INIT = 1  # the container's init process, which reaps zombies
MAX_PROCESSES = 32_768  # of a user; the limit that engines set themselves
# Exit codes of engines whose container did not start; agents may also end with them.
ENGINE_FAILED = (125, 126, 127)
# Asking the engine is the slowest part of an end, so it is asked only after exit codes with several causes.
ASKED_ABOUT = (*ENGINE_FAILED, SIGNALLED + signal.SIGKILL)
NOT_RUN = "failed to exec pid1"
NO_COMMAND = (126, 127)  # exit codes for a command that cannot be run or does not exist
NEVER = "0001-01-01"  # the start time of a container that never started
MOUNT_POINTS = (
    *("/proc", "/dev", "/sys", "/tmp", "/etc", "/run"),  # noqa: S108
    *(str(host_python.SOCKET.parent), str(GUARD)),
    str(host_python.CODE),
)
SBIN = Path("/sbin")
# No writable folders but ours: Podman must not add any for a read-only root or for an image's volumes.
PODMAN_ONLY = ("--read-only-tmpfs=false", "--image-volume", "ignore")
_numbers = itertools.count()


class OciSandbox:
    """Runs an agent in a container."""

    name = "oci"
    isolated = True
    runs_images = True

    def promises(self, limits: Limits) -> tuple[Promise, ...]:
        """Test all promises. See ``Sandbox.promises``."""
        from wildscav_evaluator.sandbox.promises import try_promises

        return try_promises(self, limits)

    async def start(self, launch: Launch) -> AgentProcess:
        """Start an agent. See ``Sandbox.start``."""
        engine = await asyncio.to_thread(find_engine)
        start_reaper(os.getpid())
        handle = ContainerHandle(engine, f"wildscav-{leftovers.owner()}-{next(_numbers)}")
        handle.command = launch.command[0] if launch.command else ""
        try:
            environment = dict(os.environ) | {"WILDSCAV_TOKEN": launch.token}
            arguments = await asyncio.to_thread(_create_command, launch, handle)
            handle.identity = await engine.run(*arguments, environment=environment)
            enter_processes(engine, handle.identity)
            return await start_process(
                [*engine.command, "start", "--attach", handle.container],
                launch,
                handle,
                kind=Container,
                environment=os.environ,
                folder=Path("/"),
            )
        except BaseException:
            await asyncio.shield(handle.release())
            raise


class ContainerHandle:
    """A handle on an agent: its container."""

    def __init__(self, engine: ContainerEngine, container: str) -> None:
        self.engine, self.container = engine, container
        self.folder = Path(
            tempfile.mkdtemp(prefix="container-", dir=leftovers.own_folder())
        )  # for the engine
        enter_container(engine, container)
        self.identity = ""  # the identity that the engine gave the container
        self.never_started = False
        self.command = ""  # the program of the submission, if it names one
        self._removed = False

    def meter(self) -> GroupMeter | None:
        """Return what measures the waits of the container's group. See ``AgentHandle.meter``."""
        for process in processes_of(self.identity) if self.identity else ():
            if group := group_of_process(process, self.identity):
                return meter_of(group)
        return None

    async def kill(self) -> None:
        """Remove the container, and thereby all its processes. See ``AgentHandle.kill``."""
        if not self._removed:
            with contextlib.suppress(SandboxError):
                await self.engine.run(*removal(self.engine, self.container))
                self._removed = True
                release_container(self.engine, self.container, self.identity)

    async def memory_kill(self, code: int) -> MemoryKill:
        """Return whose memory ran out, from the kernel's log or from the engine.

        See ``AgentHandle.memory_kill``.
        """
        if code == 0:
            return MemoryKill.NONE
        logged = await asyncio.to_thread(logged_kill, self.identity)
        if logged not in (None, MemoryKill.NONE) or code not in ASKED_ABOUT:
            return logged or MemoryKill.NONE
        with contextlib.suppress(SandboxError, ValueError):
            state = json.loads(
                await self.engine.run("inspect", "--format", "{{json .State}}", self.container)
            )
            self.never_started = str(state.get("StartedAt", NEVER)).startswith(NEVER)
            # With control groups of version 1, Podman does not notice. Then SIGKILL came from a lack of
            # memory or from the agent itself: nobody else can send it, and our own limits are reported
            # separately.
            unnoticed = self.engine.name == "podman" and has_cgroup_v1() and logged is None
            return MemoryKill.OWN if state.get("OOMKilled") or unnoticed else MemoryKill.NONE
        return MemoryKill.NONE

    async def release(self) -> None:
        """Remove the container and its folder. See ``AgentHandle.release``."""
        await self.kill()
        await asyncio.to_thread(shutil.rmtree, self.folder, ignore_errors=True)


class Container(AgentProcess):
    """One agent's container."""

    _handle: ContainerHandle

    async def ended(self) -> Ending:
        """Wait for the container to end. See ``RunningAgent.ended``."""
        ending = await super().ended()
        if self._handle.command and NOT_RUN in ending.last_words:  # Podman's init does not name the program
            return replace(ending, last_words=f"cannot run {self._handle.command}: {ending.last_words}")
        if ending.exit_code in NO_COMMAND and self._handle.command:
            return ending  # the engine reports that the image has no such program
        if ending.exit_code in ENGINE_FAILED and self._handle.never_started:
            engine = self._handle.engine.name
            return Ending(platform_fault=f"{engine} could not start the container: {ending.last_words}")
        return ending


def _create_command(launch: Launch, handle: ContainerHandle) -> list[str]:
    """Return the arguments that create an agent's container without starting it."""
    engine = handle.engine
    image, command = _image(launch, engine)
    clock, entry = _with_wall_clock(command, launch, engine)
    return [
        *("create", "--name", handle.container, "--label", f"{OWNER}={leftovers.owner()}", "--pull", "never"),
        *("--network", "none", "--hostname", "agent", "--user", _user(engine), "--no-healthcheck"),
        *("--cap-drop", "all", "--security-opt", "no-new-privileges"),
        *("--security-opt", f"seccomp={_profile(launch, handle.folder)}"),
        *("--log-driver", "none", "--read-only"),
        *(PODMAN_ONLY if engine.name == "podman" else ()),
        *clock,
        *_limits(launch.limits, engine),
        *_variables(launch),
        *_mounts(launch, handle),
        *(("--workdir", str(host_python.CODE)) if launch.image is None else ()),
        *(image, *entry),
    ]


def _with_wall_clock(
    command: Sequence[str], launch: Launch, engine: ContainerEngine
) -> tuple[list[str], list[str]]:
    """Return the options that enforce a container's wall clock, and the command in it.

    An empty command is the image's own.
    """
    seconds = launch.lasts
    if engine.name == "podman":
        return podman_options(seconds), list(command)
    if launch.image is None:
        first, *others = guarded(command, seconds)
        return ["--entrypoint", first], others
    variables = steering(image_settings(engine, launch.image).get("Env") or ())
    first, *others = guarded(image_command(engine, launch.image), seconds, variables)
    return [*without(variables), "--entrypoint", first], others


def _user(engine: ContainerEngine) -> str:
    # Where the engine cannot use any user, agents share the one who owns nothing.
    user = agent_user() if engine.all_users else host_python.NOBODY
    return f"{user}:{user}"


def _profile(launch: Launch, folder: Path) -> Path:
    path = folder / "seccomp.json"
    path.write_text(json.dumps(container_profile(locks=launch.image is not None)), "utf-8")
    return path


def _limits(limits: Limits, engine: ContainerEngine) -> list[str]:
    memory, tmp = str(int(limits.memory)), int(limits.tmp_size)
    hard = resource.getrlimit(resource.RLIMIT_NPROC)[1]
    processes = MAX_PROCESSES if hard == resource.RLIM_INFINITY else min(MAX_PROCESSES, hard)
    options = [
        *("--memory", memory, "--memory-swap", memory, "--pids-limit", str(limits.processes + INIT)),
        *("--cpus", f"{limits.cpus:.3f}", "--ulimit", "core=0:0"),
        *("--ulimit", f"nofile={limits.open_files}:{limits.open_files}"),
        *("--ulimit", f"nproc={processes}:{processes}"),
    ]
    # Podman would copy the image's files there, with their permissions.
    kind = f"rw,nosuid,nodev,size={tmp},mode=1777" + (",notmpcopyup" if engine.name == "podman" else "")
    for place in ("/tmp", "/dev/shm"):  # noqa: S108
        options += ["--tmpfs", f"{place}:{kind}"]
    return options


def _variables(launch: Launch) -> list[str]:
    """Return the options for an agent's variables. The token is passed unseen, by the environment."""
    variables = agent_variables(launch, host_python.ADDRESS) | {"HOME": "/tmp"}  # noqa: S108
    if launch.image is None:
        variables |= host_python.host_runtime().variables()
    del variables["WILDSCAV_TOKEN"]
    named = [word for name, value in variables.items() for word in ("--env", f"{name}={value}")]
    return [*named, "--env", "WILDSCAV_TOKEN"]


def _image(launch: Launch, engine: ContainerEngine) -> tuple[str, list[str]]:
    """Return an agent's image, and the command in it; an empty one for the image's own."""
    if launch.image is not None:
        return launch.image, []
    host = _host_runtime(engine)
    places = {*MOUNT_POINTS, *(str(there) for there in host.folders if not there.is_file())}
    folders = tuple(sorted(places | {str(there.parent) for there in host.links} - {"/"}))
    links = tuple((str(there), target) for there, target in host.links.items())
    return bare_image(engine, folders, links), python_command(launch)


def _host_runtime(engine: ContainerEngine) -> host_python.Runtime:
    """Return this machine's Python in the form in which an engine can mount it."""
    host = host_python.host_runtime()
    # Docker puts its init into /sbin, so that must not be a link into our /usr.
    if engine.name == "docker":
        folders = {there: here for there, here in host.folders.items() if there != SBIN}
        links = {there: target for there, target in host.links.items() if there != SBIN}
        # Python finds libraries with ldconfig.
        return host_python.Runtime(folders, links | {SBIN / "ldconfig": "/usr/sbin/ldconfig"})
    return host


def _mounts(launch: Launch, handle: ContainerHandle) -> list[str]:
    """Return the options for mounts: the sockets, and code and Python if the agent has no image."""
    mounts = host_python.sockets(launch.address, launch.model)
    for socket in mounts.values():
        socket.chmod(0o666)  # its private folder protects it from others
    if handle.engine.name == "docker":
        mounts |= guard_files() if launch.image is None else _copied_guard(handle.folder)
    if launch.image is None:
        code = {host_python.CODE: stage(launch.folder, handle.folder)}
        mounts = _host_runtime(handle.engine).folders | code | mounts
    return [
        word
        for there, here in mounts.items()
        for word in ("--mount", f"type=bind,source={_plain(here)},destination={_plain(there)},readonly")
    ]


def _copied_guard(folder: Path) -> dict[Path, Path]:
    """Copy the guard's files for one container, because an agent that may lock files must share none."""
    copies = folder / "guard"
    copies.mkdir()
    return {there: Path(shutil.copy(here, copies / there.name)) for there, here in guard_files().items()}


def _plain(path: Path) -> str:
    """Return a path in the form that mount options accept; SandboxError if they do not accept it."""
    if any(character in str(path) for character in ',"\n'):
        raise SandboxError(f"{path}: containers cannot mount a path with commas, quotes or line breaks")
    return str(path)
