"""The sandbox of bubblewrap: separate namespaces, a filter of system calls, and a control group.

An agent sees this machine's Python and its own code, both read-only, its own ``/tmp`` in memory, and one unix
socket. It runs as a user that owns nothing. See ``docs/security.md``.
"""

import asyncio
import os
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.sandbox.agents import host_python
from wildscav_evaluator.sandbox.agents.agent_process import (
    AgentProcess,
    agent_variables,
    python_command,
    start_process,
)
from wildscav_evaluator.sandbox.base import Launch, MemoryKill, Promise, SandboxError
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.sandbox.linux.cgroup import AgentGroup, find_version, meter_of
from wildscav_evaluator.sandbox.linux.seccomp import bpf_filter
from wildscav_evaluator.sandbox.linux.users import agent_user
from wildscav_evaluator.sandbox.processor_waits import GroupMeter
from wildscav_evaluator.submission_files import stage
from wildscav_server import leftovers

# Enters the control group, limits open files, and becomes bubblewrap.
ENTER = """
while [ "$1" != -- ]; do echo 0 > "$1" || exit 125; shift; done; shift
ulimit -c 0 && ulimit -n "$1" || exit 125; shift
exec "$@"
"""


class BubblewrapSandbox:
    """Runs an agent in bubblewrap."""

    name = "bubblewrap"
    isolated = True
    runs_images = False

    def promises(self, limits: Limits) -> tuple[Promise, ...]:
        """Test all promises. See ``Sandbox.promises``."""
        from wildscav_evaluator.sandbox.promises import try_promises

        return try_promises(self, limits)

    async def start(self, launch: Launch) -> AgentProcess:
        """Start an agent. See ``Sandbox.start``."""
        if launch.image is not None:
            raise UserError(f"image {launch.image} needs --sandbox oci: bubblewrap runs folders only")
        if shutil.which("bwrap") is None:
            raise SandboxError("there is no bubblewrap: install it (package bubblewrap)")
        handle = CgroupHandle(AgentGroup(find_version(), launch.limits))
        agent = None
        try:
            handle.folder = await asyncio.to_thread(stage, launch.folder, handle.private)
            agent = await _start(launch, handle)
            await _await_start(agent, handle)
        except BaseException:
            await (handle.release() if agent is None else agent.stop())
            raise
        return agent


async def _start(launch: Launch, handle: "CgroupHandle") -> AgentProcess:
    """Start bubblewrap, without waiting until it has started the agent."""
    filter_fd = os.memfd_create("seccomp")
    handle.status, status = os.pipe()
    try:
        os.write(filter_fd, bpf_filter())
        os.lseek(filter_fd, 0, os.SEEK_SET)
        variables = host_python.host_runtime().variables() | agent_variables(launch, host_python.ADDRESS)
        return await start_process(
            _command(launch, handle, filter_fd, status),
            launch,
            handle,
            environment=variables,
            folder=Path("/"),
            pass_fds=(filter_fd, status),
        )
    finally:
        os.close(filter_fd)
        os.close(status)


class CgroupHandle:
    """A handle on an agent: its control group."""

    def __init__(self, group: AgentGroup) -> None:
        self.group = group
        self.folder = Path()  # the folder of the code
        self.private = Path(tempfile.mkdtemp(prefix="code-", dir=leftovers.own_folder()))  # for a copy of it
        self.status: int | None = None  # the pipe of bubblewrap's reports, open while it runs

    def meter(self) -> GroupMeter | None:
        """Return what measures the waits of the group. See ``AgentHandle.meter``."""
        return meter_of(self.group.counted)

    async def kill(self) -> None:
        """Kill the group. See ``AgentHandle.kill``."""
        await asyncio.to_thread(self.group.kill)

    async def memory_kill(self, code: int) -> MemoryKill:  # noqa: ARG002
        """Return whose memory ran out. See ``AgentHandle.memory_kill``."""
        return self.group.memory_kill()

    async def release(self) -> None:
        """Remove the group, and the copy of the code. See ``AgentHandle.release``."""
        await asyncio.to_thread(self.group.remove)
        if self.status is not None:
            os.close(self.status)
            self.status = None
        await asyncio.to_thread(shutil.rmtree, self.private, ignore_errors=True)


async def _await_start(agent: AgentProcess, handle: CgroupHandle) -> None:
    """Wait until bubblewrap has become the agent; SandboxError if it could not."""
    if handle.status is not None and b'"child-pid"' in await asyncio.to_thread(os.read, handle.status, 4096):
        return
    ending = await agent.ended()
    raise SandboxError(f"bubblewrap could not start: {ending.last_words or ending}")


def _command(launch: Launch, handle: CgroupHandle, filter_fd: int, status_fd: int) -> list[str]:
    """Return the whole command that starts an agent."""
    limits = launch.limits
    as_user, drop = _user()
    return [
        *("/bin/sh", "-c", ENTER, "sh", *map(str, handle.group.entrances), "--", str(limits.open_files)),
        *("bwrap", "--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts"),
        "--unshare-cgroup-try",
        *("--die-with-parent", "--new-session", "--hostname", "agent", *as_user),
        *("--seccomp", str(filter_fd), "--json-status-fd", str(status_fd)),
        *_mounts(launch, handle.folder, int(limits.tmp_size)),
        *("--chdir", str(host_python.CODE), "--", *drop, *python_command(launch)),
    ]


def _mounts(launch: Launch, folder: Path, tmp_size: int) -> list[str]:
    """Return the options for mounts. Everything writable is in memory, with a limited size."""
    host = host_python.host_runtime()
    mounts = []
    for parent in _parents([*host.folders, host_python.CODE, host_python.SOCKET]):
        mounts += ["--perms", "0755", "--dir", str(parent)]
    for there, here in host.folders.items():
        mounts += ["--ro-bind", str(here), str(there)]
    for there, target in host.links.items():
        mounts += ["--symlink", target, str(there)]
    sockets = host_python.sockets(launch.address, launch.model)
    if os.getuid() == 0:
        for socket in sockets.values():
            socket.chmod(0o666)  # its private folder protects it from others
    return [
        *("--proc", "/proc", "--dev", "/dev"),
        # Before the rest, because the host's Python may be in a folder below /tmp.
        *("--perms", "1777", "--size", str(tmp_size), "--tmpfs", "/tmp"),  # noqa: S108
        *mounts,
        *("--perms", "1777", "--size", str(tmp_size), "--tmpfs", "/dev/shm"),  # noqa: S108
        *("--ro-bind", str(folder), str(host_python.CODE)),
        *(word for there, here in sockets.items() for word in ("--ro-bind", str(here), str(there))),
        *("--remount-ro", "/dev", "--remount-ro", "/"),
    ]


def _parents(targets: Sequence[Path]) -> list[Path]:
    """Return the folders above some targets, parents first; bubblewrap would make them inaccessible."""
    parents = {parent for target in targets for parent in target.parents if parent != Path("/")}
    return sorted(parent for parent in parents if not any(parent.is_relative_to(path) for path in targets))


def _user() -> tuple[list[str], list[str]]:
    """Return options for bubblewrap, and a command prefix, that run an agent as a user who owns nothing.

    Root can give each agent its own user number, so that agents do not share what the kernel counts by user.
    Other users can only make it appear as nobody, in a user namespace.
    """
    if os.getuid() != 0:
        return ["--unshare-user", "--uid", str(host_python.NOBODY), "--gid", str(host_python.NOBODY)], []
    user = str(agent_user())
    capabilities = ("CAP_SETUID", "CAP_SETGID", "CAP_SETPCAP")
    options = ["--cap-drop", "ALL", *(word for name in capabilities for word in ("--cap-add", name))]
    drop = ["setpriv", "--reuid", user, "--regid", user, "--clear-groups"]
    return options, [*drop, "--bounding-set", "-all", "--inh-caps", "-all"]
