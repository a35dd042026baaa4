"""Control groups: the kernel's limits on the memory, processes and processor time of a whole agent.

Version 2 (https://docs.kernel.org/admin-guide/cgroup-v2.html) if it has the controllers, otherwise version 1.
Groups are placed below the evaluator's own, or as near as the kernel allows, so that limits on the evaluation
also apply to its agents.
"""

import contextlib
import itertools
import json
import os
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from wildscav_evaluator.sandbox.base import MemoryKill, SandboxError
from wildscav_evaluator.sandbox.limits import Limits
from wildscav_evaluator.sandbox.processes import kill
from wildscav_evaluator.sandbox.processor_waits import GroupMeter
from wildscav_server import leftovers

CONTROLLERS = ("cpu", "memory", "pids")
ACCOUNTS = "cpuacct"  # version 1's controller that counts processor time; often one with cpu
PERIOD = 100_000  # µs in which an agent gets its share of processor time
OVERHEAD = 2  # processes of the sandbox itself
PREFIX = "wildscav-"  # then the group's owner, as `wildscav_server.leftovers` names it, and a number
KIND = "control group"  # in the lists of owners
# Bytes below its limit from which a group's peak counts as having reached it. The kernel kills for requests
# of up to 8 pages that do not fit, which is less.
REACHED_LIMIT_MARGIN = 1 << 20
KILL_TIME = 10.0  # s, at most, to kill a group
MOUNTS = Path("/proc/self/mountinfo")
OWN = Path("/proc/self/cgroup")
_numbers = itertools.count()


@dataclass(frozen=True)
class Version1:
    """Control groups of version 1: one folder per controller, in which groups may be created."""

    parents: Mapping[str, Path]

    def settings(self, limits: Limits) -> dict[str, dict[str, str]]:
        """Return the values to write to each file of each controller, in order."""
        memory = {"memory.limit_in_bytes": str(int(limits.memory))}
        if (self.parents["memory"] / "memory.memsw.limit_in_bytes").exists():
            memory["memory.memsw.limit_in_bytes"] = str(int(limits.memory))
        elif len(Path("/proc/swaps").read_text("ascii").splitlines()) > 1:
            raise SandboxError(
                "the memory limit cannot be kept: this machine swaps and does not account for it "
                "(start it with swapaccount=1, or turn swap off)"
            )
        return {
            "memory": memory,
            "pids": {"pids.max": str(limits.processes + OVERHEAD)},
            "cpu": {"cpu.cfs_period_us": str(PERIOD), "cpu.cfs_quota_us": str(int(limits.cpus * PERIOD))},
            **({ACCOUNTS: {}} if ACCOUNTS in self.parents else {}),
        }

    def memory_kill(self, group: Path) -> MemoryKill:
        """Return whose memory ran out, if the kernel killed processes of a group.

        Version 1 counts kills without their reason. So the group's peak usage decides: if it never reached
        its own limit, it was killed because others needed memory.
        """
        if not _counter(group / "memory.oom_control", "oom_kill"):
            return MemoryKill.NONE
        limit = _number(group / "memory.limit_in_bytes")
        # If swap is accounted for, memory and swap together have the same limit.
        most = max(_number(group / f"{kind}.max_usage_in_bytes") for kind in ("memory", "memory.memsw"))
        return MemoryKill.OWN if most > limit - REACHED_LIMIT_MARGIN else MemoryKill.MACHINES


@dataclass(frozen=True)
class Version2:
    """Control groups of version 2: the folder in which groups with all controllers may be created."""

    parents: Mapping[str, Path]  # one, under the name "memory"

    def settings(self, limits: Limits) -> dict[str, dict[str, str]]:
        """Return the values to write to each file."""
        files = {
            "memory.max": str(int(limits.memory)),
            "pids.max": str(limits.processes + OVERHEAD),
            "cpu.max": f"{int(limits.cpus * PERIOD)} {PERIOD}",
        }
        if len(Path("/proc/swaps").read_text("ascii").splitlines()) > 1:
            files["memory.swap.max"] = "0"
        return {"memory": files}

    def memory_kill(self, group: Path) -> MemoryKill:
        """Return whose memory ran out, if the kernel killed processes of a group.

        Version 2 counts all kills under "oom_kill", and under "oom" how often the group reached its own
        limit.
        """
        events = group / "memory.events"
        if not _counter(events, "oom_kill"):
            return MemoryKill.NONE
        return MemoryKill.OWN if _counter(events, "oom") else MemoryKill.MACHINES


class AgentGroup:
    """The group of one agent: one folder per controller that has its own hierarchy, as the version has it.

    SandboxError if a limit could not be set.
    """

    def __init__(self, version: Version1 | Version2, limits: Limits) -> None:
        self._version = version
        name = f"{PREFIX}{leftovers.owner()}-{next(_numbers)}"
        self._folders = {controller: parent / name for controller, parent in version.parents.items()}
        self._entry = json.dumps([str(folder) for folder in self._folders.values()])
        leftovers.claim(KIND, self._entry)
        try:
            for controller, files in version.settings(limits).items():
                self._folders[controller].mkdir(exist_ok=controller == ACCOUNTS)  # which may be one with cpu
                for file, value in files.items():
                    _set(self._folders[controller] / file, value)
        except BaseException:
            self.remove()
            raise

    @property
    def counted(self) -> "CountedGroup":
        """Its counters of processor time."""
        return CountedGroup(self._folders)

    @property
    def entrances(self) -> list[Path]:
        """The files to which a process writes 0 to join the group."""
        return [folder / "cgroup.procs" for folder in self._folders.values()]

    def memory_kill(self) -> MemoryKill:
        """Return whose memory ran out, if the kernel killed processes of the group."""
        return self._version.memory_kill(self._folders["memory"])

    def kill(self) -> None:
        """Kill every process of the group."""
        _kill(self._folders["memory"])

    def remove(self) -> None:
        """Remove the group, whose processes have all ended."""
        if _remove_all(self._folders.values()):
            leftovers.release(KIND, self._entry)


class CountedGroup:
    """A group's counters of processor time. See ``processor_waits.Group``.

    The folders are by controller, as in ``Version1.parents`` or ``Version2.parents``.
    """

    def __init__(self, folders: Mapping[str, Path]) -> None:
        self._folder = folders.get("cpu", folders["memory"])
        self.counters: tuple[Path, ...] = (self._folder / "cpu.stat",)
        if "cpu" in folders:
            # Without the other controller there is no such file, and nothing is measured.
            self.counters += (folders.get(ACCOUNTS, self._folder) / "cpuacct.usage",)

    def members(self) -> list[int]:
        """Return its processes."""
        return _members(self._folder)

    def used(self, contents: list[bytes]) -> tuple[float, float]:
        """Return how long its threads ran, and how long its limit held it back, s."""
        words = contents[0].split()
        numbers = dict(zip(words[::2], map(int, words[1::2]), strict=True))
        if len(contents) > 1:
            return int(contents[1]) / 1e9, numbers[b"throttled_time"] / 1e9
        return numbers[b"usage_usec"] / 1e6, numbers[b"throttled_usec"] / 1e6


def group_of_process(process: int, name: str) -> CountedGroup | None:
    """Return the group with a name that a process is in; None if there is none on this machine."""
    with contextlib.suppress(OSError, SandboxError):
        mounts, paths = _mounts(), _paths_of(Path(f"/proc/{process}/cgroup"))
        kinds = {name: name for name in ("cpu", ACCOUNTS) if name in mounts} or {"": "memory"}
        folders = {kind: mounts[key] / paths[key].lstrip("/") for key, kind in kinds.items() if key in paths}
        if folders and all(
            name in folder.name and process in _members(folder) for folder in folders.values()
        ):
            return CountedGroup({"memory": Path(), **folders})
    return None


def meter_of(group: CountedGroup | None) -> GroupMeter | None:
    """Return what measures a group's waits for a processor; None if the kernel does not count them."""
    with contextlib.suppress(OSError):
        return None if group is None else GroupMeter(group)
    return None


def remove_left_group(entry: str) -> None:
    """Remove a group that was entered in the list of a dead owner, and kill its processes."""
    folders = [Path(folder) for folder in json.loads(entry)]
    for folder in folders:
        _kill(folder)
    if not _remove_all(folders):
        raise OSError(f"{folders[0]} cannot be removed")


leftovers.register(KIND, remove_left_group)


def find_version() -> Version1 | Version2:
    """Return where groups can be created; SandboxError, which says why, if nowhere."""
    mounts = _mounts()
    paths = _paths_of(OWN)
    version: Version1 | Version2
    if all(controller in mounts for controller in CONTROLLERS):
        places = {name: _beneath(mounts[name], paths.get(name, "/")) for name in mounts if name}
        if not os.access(places.get(ACCOUNTS, ""), os.W_OK):
            places.pop(ACCOUNTS, None)  # it limits nothing: waits for a processor are not measured then
        version = Version1(places)
    elif "" in mounts:
        version = Version2({"memory": _delegated(mounts[""], paths.get("", "/"))})
    else:
        raise SandboxError("no limits on memory, processes and CPU: no control groups are mounted")
    for controller, parent in version.parents.items():
        if not os.access(parent, os.W_OK):
            raise SandboxError(f"no limit on {controller} can be set: {parent} is not writable; {REMEDY}")
    return version


REMEDY = (
    "evaluate as root, or with systemd as `systemd-run --user --scope -p Delegate=yes wildscav …`, "
    "which gives you a control group of your own"
)


def _mounts() -> dict[str, Path]:
    """Return the mount points of version 1's controllers, and that of version 2 under the empty name."""
    found = {}
    for line in MOUNTS.read_text("utf-8").splitlines():
        # "36 35 98:0 /root /mount options … - type source super-options"
        before, _, after = line.partition(" - ")
        kind, _, options = after.split(" ", 2)
        place = Path(before.split()[4].replace("\\040", " "))
        if kind == "cgroup2":
            found[""] = place
        elif kind == "cgroup":
            found.update(dict.fromkeys(set(options.split(",")) & {*CONTROLLERS, ACCOUNTS}, place))
    return found


def _paths_of(file: Path) -> dict[str, str]:
    """Return the path of a process's group for each controller; version 2's under the empty name."""
    paths = {}
    for line in file.read_text("utf-8").splitlines():
        _, controllers, path = line.split(":", 2)
        paths.update(dict.fromkeys(controllers.split(","), path))
    return paths


def _beneath(mount: Path, path: str) -> Path:
    """Return the folder of a group, or the mount point if only a part of the tree is mounted."""
    folder = mount / path.lstrip("/")
    return folder if folder.is_dir() else mount


def _delegated(mount: Path, path: str) -> Path:
    """Return the nearest group at or above a path that may contain groups with all controllers."""
    folder = _beneath(mount, path)
    for parent in (folder, *folder.parents):
        if _offers_controllers(parent) and os.access(parent / "cgroup.procs", os.W_OK):
            return parent
        if parent == mount:
            break
    raise SandboxError(f"no limits on memory, processes and CPU can be set beneath {folder}; {REMEDY}")


def _offers_controllers(folder: Path) -> bool:
    """Return whether groups in a folder have all controllers, after trying to enable them."""
    control = folder / "cgroup.subtree_control"
    with contextlib.suppress(OSError):
        if set(CONTROLLERS) <= set(control.read_text("ascii").split()):
            return os.access(folder, os.W_OK)
        control.write_text(" ".join(f"+{name}" for name in CONTROLLERS), "ascii")
        return set(CONTROLLERS) <= set(control.read_text("ascii").split())
    return False


def _set(file: Path, value: str) -> None:
    try:
        file.write_text(value, "ascii")
    except OSError as error:
        raise SandboxError(
            f"a limit cannot be kept: {file} does not take {value}: {error.strerror}"
        ) from None


def _counter(file: Path, name: str) -> int:
    with contextlib.suppress(OSError):
        for line in file.read_text("ascii").splitlines():
            if line.split()[0] == name:
                return int(line.split()[1])
    return 0


def _number(file: Path) -> int:
    """Return the number in a file; 0 if the file does not exist."""
    try:
        return int(file.read_text("ascii"))
    except OSError:
        return 0


def _members(folder: Path) -> list[int]:
    try:
        return [int(line) for line in (folder / "cgroup.procs").read_text("ascii").split()]
    except OSError:
        return []


def _kill(folder: Path) -> None:
    """Kill every process of a group."""
    with contextlib.suppress(OSError):
        (folder / "cgroup.kill").write_text("1")  # version 2, from Linux 5.14 on
    end = time.monotonic() + KILL_TIME
    while (members := _members(folder)) and time.monotonic() < end:
        for process in members:
            kill(process, lambda process: process in _members(folder))
        time.sleep(0.001)


def _remove_all(folders: Iterable[Path]) -> bool:
    """Remove as many of the groups as possible, and return whether all are gone."""
    gone = [_remove(folder) for folder in folders]
    return all(gone)


def _remove(folder: Path) -> bool:
    """Remove a group, and return whether it is gone."""
    for _ in range(100):  # processes leave their group a little after they end
        try:
            folder.rmdir()
        except FileNotFoundError:
            return True
        except OSError:
            time.sleep(0.002)
        else:
            return True
    return False
