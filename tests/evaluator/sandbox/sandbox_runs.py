"""What an escaping agent would like to reach: sockets, files and another agent, all of them real."""

import asyncio
import contextlib
import functools
import json
import os
import shutil
import socket
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wildscav_evaluator.matches.play import launch_for
from wildscav_evaluator.sandbox import SANDBOXES, Ending, Launch, Limits, Sandbox
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers

MEBIBYTE = 1 << 20
GROUPS = Path("/sys/fs/cgroup")
LIMITS = Limits(
    cpus=0.25,
    memory=256 * MEBIBYTE,  # type: ignore[arg-type]
    processes=48,
    open_files=128,
    tmp_size=16 * MEBIBYTE,  # type: ignore[arg-type]
    output=256_000,  # type: ignore[arg-type]
)
# Each goes beyond its limit, but not by much.
BEYOND = {"cpus": 0.4, "memory": 400 * MEBIBYTE, "processes": 64, "open_files": 256, "disk": 20 * MEBIBYTE}
FLOOD = 8 * MEBIBYTE
ATTACKER = Path(__file__).parent / "attacker"
VICTIM = """
import time
with open("/tmp/{file}", "w") as file:
    file.write("a secret")
print("ready", flush=True)
time.sleep(300)
"""


@dataclass(frozen=True)
class Report:
    """What came of an agent's attacks."""

    worked: dict[str, bool]  # of each attack
    details: dict[str, str]
    ending: Ending
    log_size: int  # bytes
    survivors: list[int]  # processes that were still there after the end
    written: bool  # whether its own code folder has something new


def attack(sandbox: str, **limits: object) -> Report:
    """Let the attacker loose in a sandbox, beside a victim in another of the same kind."""
    with world() as (folder, orders):
        return asyncio.run(_attack(sandbox, folder, orders, LIMITS.model_copy(update=limits)))


async def _attack(sandbox: str, folder: Path, orders: dict[str, object], limits: Limits) -> Report:
    runner = SANDBOXES[sandbox]
    code = shutil.copytree(ATTACKER, folder / "attacker")
    victim_code = folder / "victim"
    victim_code.mkdir()
    (victim_code / "agent.py").write_text(VICTIM.format(file=Path(str(orders["other_file"])).name))
    address = f"unix:{orders['own_socket']}"
    victim = await runner.start(
        Launch(victim_code, "agent:Victim", address, str(orders["other_token"]), folder / "victim.log")
    )
    try:
        await _printed(folder / "victim.log", "ready")
        orders["other_process"] = _process_with(str(orders["other_token"]))
        orders["marker"] = "agent:Victim"
        (code / "orders.json").write_text(json.dumps(orders))
        launch = Launch(code, "agent:Attacker", address, "own-token", folder / "attacker.log", limits)
        attacker = await runner.start(launch)
        try:
            ending = await asyncio.wait_for(attacker.ended(), 60)
        finally:
            await attacker.stop()
    finally:
        await victim.stop()
        with contextlib.suppress(OSError):
            Path(str(orders["other_file"])).unlink()
    await asyncio.sleep(0.1)
    log = (folder / "attacker.log").read_text()
    return Report(
        **_read(log),
        ending=ending,
        log_size=len(log),
        survivors=processes_with(str(orders["survivor"])),
        written=(code / "left-behind").exists(),
    )


def _read(log: str) -> dict[str, dict[str, object]]:
    worked: dict[str, object] = {}
    details: dict[str, object] = {}
    for line in log.splitlines():
        if line.startswith("ATTACK "):
            _, name, *rest = line.split(" ")
            worked[name], details[name] = rest == ["worked"], " ".join(rest)
    assert "FLOOD" in log, log
    return {"worked": worked, "details": details}


@contextlib.contextmanager
def world() -> Iterator[tuple[Path, dict[str, object]]]:
    """Set up what there is to reach; yield its folder and where everything is."""
    folder = Path(tempfile.mkdtemp(prefix="wildscav-escape-"))
    unique = uuid.uuid4().hex
    (folder / "seeds.txt").write_text("1 2 3")
    (folder / "open").mkdir(mode=0o777)
    (folder / "open").chmod(0o777)
    folder.chmod(0o755)  # whoever sees it may look into it
    with contextlib.ExitStack() as stack:

        def listen(family: int, address: object) -> Any:
            return stack.enter_context(_listener(family, address)).getsockname()

        orders: dict[str, object] = {
            **BEYOND,
            "port_ipv4": listen(socket.AF_INET, ("127.0.0.1", 0))[1],
            "port_ipv6": listen(socket.AF_INET6, ("::1", 0))[1],
            "abstract_socket": listen(socket.AF_UNIX, f"\0{unique}")[1:].decode(),
            "own_socket": listen(socket.AF_UNIX, str(folder / "own.sock")),
            "other_socket": listen(socket.AF_UNIX, str(folder / "other.sock")),
            "seeds": str(folder / "seeds.txt"),
            "users": Path("/etc/passwd").read_text(),
            "folder": str(folder / "open"),
            "other_code": str(folder / "victim" / "agent.py"),
            "other_file": f"/tmp/{unique}",  # noqa: S108
            "other_token": f"token-{unique}",
            "survivor": f"survivor-{unique}",
            "flood": FLOOD,
        }
        try:
            yield folder, orders
        finally:
            shutil.rmtree(folder)


@contextlib.contextmanager
def tight_group(parent: Path, memory: int) -> Iterator[Path]:
    """Make a control group, in which others may be made, that has less memory than they may use; yield it."""
    group = parent / f"wildscav-tight-{os.getpid()}"
    group.mkdir()
    try:
        if (group / "memory.max").exists():  # version 2
            (group / "cgroup.subtree_control").write_text("+cpu +memory +pids")
            (group / "memory.max").write_text(str(memory))
        else:
            (group / "memory.limit_in_bytes").write_text(str(memory))
        yield group
    finally:
        # Podman makes more of the name, and leaves them.
        for place in {group, *GROUPS.glob(f"*/{group.name}")}:
            wait_until(functools.partial(_remove_group, place))


def _remove_group(group: Path) -> bool:
    """Remove a group with those in it, and return whether that worked: the dead leave it late."""
    inner = sorted(entry for entry in group.rglob("*") if entry.is_dir())
    try:
        for folder in (*reversed(inner), group):
            folder.rmdir()
    except OSError:
        return not group.exists()
    return True


def run_agent(
    sandbox: Sandbox, submission: Submission, folder: Path, limits: Limits = LIMITS, **options: Any
) -> tuple[Ending, str]:
    """Run an agent to its end; return how it ended and what is in its log."""
    log = options.pop("log", folder / "log")

    async def to_end(address: str) -> Ending:
        launch = launch_for(submission, address, "of the seat", log, limits)
        agent = await sandbox.start(replace(launch, **options))
        try:
            return await agent.ended()
        finally:
            await agent.stop()

    with listening(folder / "match.sock") as address:
        ending = asyncio.run(to_end(address))
    return ending, log.read_text() if log.is_file() else ""


@contextlib.contextmanager
def listening(path: Path) -> Iterator[str]:
    """Listen on a unix socket; yield its address."""
    with _listener(socket.AF_UNIX, str(path)):
        yield f"unix:{path}"


def _listener(family: int, address: object) -> socket.socket:
    listener = socket.socket(family)
    listener.bind(address)
    listener.listen()
    return listener


async def _printed(log: Path, word: str) -> None:
    for _ in range(400):
        if log.exists() and word in log.read_text():
            return
        await asyncio.sleep(0.05)
    raise AssertionError(log.read_text() if log.exists() else "nothing was printed")


def _process_with(token: str) -> int:
    """Return the agent's process, as the host numbers it, that has a token."""
    found = [process for process in _processes() if token in _read_file(process, "environ")]
    return max(process for process in found if "wildscav.sdk" in _read_file(process, "cmdline"))


def processes_with(word: str) -> list[int]:
    """Return the processes that have a word in their command line."""
    return [process for process in _processes() if word in _read_file(process, "cmdline")]


def _processes() -> list[int]:
    return [int(entry) for entry in os.listdir("/proc") if entry.isdecimal()]  # noqa: PTH208


def _read_file(process: int, name: str) -> str:
    try:
        return Path(f"/proc/{process}/{name}").read_text(errors="replace")
    except OSError:
        return ""


def folders_of(process: int) -> list[Path]:
    """Return the folders of a process for temporary things, once those of the dead are removed."""
    leftovers.sweep()
    locks = Path(tempfile.gettempdir()).glob(f"wildscav-*/{leftovers.LOCK}")
    return [lock.parent for lock in locks if lock.read_text().strip() == str(process)]


def wait_until(condition: Callable[[], bool], seconds: float = 120.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it took too long"
        time.sleep(0.05)
