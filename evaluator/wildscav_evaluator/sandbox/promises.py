"""Testing a sandbox's promises on this machine, with a probe that runs in it and tries to break each."""

import asyncio
import json
import secrets
import shutil
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from wildscav_evaluator.sandbox.agents.capped_log import CUT
from wildscav_evaluator.sandbox.base import Launch, Promise, Sandbox, SandboxError
from wildscav_evaluator.sandbox.limits import MEBIBYTE, Limits
from wildscav_evaluator.sandbox.processes import all_processes, read_file
from wildscav_server import leftovers

PROBE = Path(__file__).parent / "probe" / "agent.py"
# Small limits, which are quick to test. A sandbox that enforces these also enforces others.
TRIED = {
    "cpus": 0.5,
    "memory": 128 * MEBIBYTE,
    "processes": 32,
    "tmp_size": 4 * MEBIBYTE,
    "output": 64 * 1024,
}
LASTS = 30.0  # s, of the probe at most
TOLERANCE = 1.3  # factor for processor time, which is granted in slices
NO_CAPABILITIES = "0" * 16
HAS_FILTER = "2"


def try_promises(sandbox: Sandbox, limits: Limits) -> tuple[Promise, ...]:
    """Run the probe in a sandbox, and return what it found for each promise.

    Must not be called from a running event loop.
    """
    tried = limits.model_copy(update=TRIED)
    with _probe_folder(tried) as folder:
        try:
            report = asyncio.run(_probe(sandbox, folder, tried))
        except SandboxError as error:
            return (Promise("an agent can be started", kept=False, found=str(error)),)
        except OSError as error:
            return (Promise("an agent can be started", kept=False, found=error.strerror or str(error)),)
    return tuple(_judge(report, tried))


@contextmanager
def _probe_folder(limits: Limits) -> Iterator[Path]:
    """Make a folder with the probe, its orders, and a socket like that of a match."""
    with leftovers.temporary_folder("probe-") as folder:
        code = folder / "code"
        code.mkdir(mode=0o755)
        shutil.copy(PROBE, code / "agent.py")
        orders = {
            "hidden": [str(folder), *_home_files(), "/etc/shadow", "/var/lib", "/boot"],
            "processes": 2 * limits.processes,
            "memory": 2 * int(limits.memory),
            "output": 4 * int(limits.output),
        }
        (code / "orders.json").write_text(json.dumps(orders), "utf-8")
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(folder / "match.sock"))
            listener.listen()
            yield folder


def _home_files() -> list[str]:
    """Return the entries of the user's home folder, except those that lead to Python.

    The home of a user without one, as in containers, is the root folder, which agents also have.
    """
    python, home = [Path(sys.base_prefix), Path(sys.prefix)], Path.home()
    entries = home.iterdir() if home.is_dir() and home != Path("/") else ()
    return [str(entry) for entry in entries if not any(path.is_relative_to(entry) for path in python)]


async def _probe(sandbox: Sandbox, folder: Path, limits: Limits) -> dict[str, Any]:
    """Return the probe's findings, and what was left of it after its end."""
    log, token = folder / "log", secrets.token_hex()
    launch = Launch(
        folder=folder / "code",
        entry_point="agent:Probe",
        address=f"unix:{folder / 'match.sock'}",
        token=token,
        log=log,
        limits=limits,
        lasts=LASTS,
    )
    agent = await sandbox.start(launch)
    try:
        ending = await agent.ended()
    finally:
        await agent.stop()
    text = log.read_text("utf-8", "replace") if log.exists() else ""
    try:
        report: dict[str, Any] = json.loads(text.partition("\n")[0])
    except ValueError:
        raise SandboxError(f"the probe did not run: {ending}") from None
    left = sum(token.encode() in read_file(process, "environ") for process in all_processes())
    return report | {"printed": len(text.partition(f"\n{CUT}")[0]), "left": left}


def _judge(report: dict[str, Any], limits: Limits) -> Iterator[Promise]:
    """Yield every promise with the finding on it."""
    yield _promise(
        "no network", report["interfaces"] == ["lo"], f"interfaces: {_words(report['interfaces'])}"
    )
    yield _promise(
        "no files of this machine",
        not report["files_seen"],
        f"seen: {_words(report['files_seen'])}",
    )
    places = report["writable"]
    yield _promise(
        "read-only code, and files in memory alone",
        {"/tmp"} <= set(places) <= {"/tmp", "/dev/shm"},  # noqa: S108
        f"can write to {_words(places)}",
    )
    yield from _judge_rights(report)
    yield _promise(
        "processes of its own", len(report["processes_seen"]) <= FEW, f"sees {len(report['processes_seen'])}"
    )
    yield from _judge_limits(report, limits)
    yield _promise("nothing is left of it", report["left"] == 0, f"{report['left']} processes")


FEW = 8  # processes, at most, that an agent may see, including those of the sandbox
FILTER = "install libseccomp2"


def _judge_rights(report: dict[str, Any]) -> Iterator[Promise]:
    """Yield the promises on the agent's rights."""
    users = sorted(set(report["user"]))
    yield _promise("not root", 0 not in users, f"user and groups: {_words(users)}")
    yield _promise(
        "no capabilities, now or later",
        set(report["capabilities"]) == {NO_CAPABILITIES} and report["no_new_privileges"] == "1",
        f"{_words(sorted(set(report['capabilities'])))}, no new privileges: {report['no_new_privileges']}",
    )
    yield _promise(
        "no user namespaces", bool(report["namespaces"]), report["namespaces"] or "one could be made", FILTER
    )
    yield _promise(
        "no tracing, a filter of system calls",
        bool(report["tracing"]) and report["filter"] == HAS_FILTER,
        report["tracing"] or "a process could be traced",
        FILTER,
    )


def _judge_limits(report: dict[str, Any], limits: Limits) -> Iterator[Promise]:
    memory, tmp = report["memory"], max(report["writable"].values(), default=0)
    yield _promise(
        "limit on memory", memory <= limits.memory, f"{_size(memory)} of {_size(limits.memory)}", GROUPS
    )
    yield _promise(
        "limit on processes",
        report["processes"] <= limits.processes,
        f"{report['processes']} of {limits.processes}",
        GROUPS,
    )
    yield _promise(
        "limit on processor time",
        report["cores"] <= limits.cpus * TOLERANCE,
        f"{report['cores']:.2f} cores measured, up to {limits.cpus * TOLERANCE:.2f} pass for {limits.cpus:g}",
        GROUPS,
    )
    yield _promise(
        "limit on open files",
        report["open_files"] <= limits.open_files,
        f"{report['open_files']} of {limits.open_files}",
    )
    yield _promise(
        "limit on files in /tmp", tmp <= limits.tmp_size, f"{_size(tmp)} of {_size(limits.tmp_size)}"
    )
    yield _promise(
        "limit on output",
        report["printed"] <= limits.output,
        f"{report['printed']:,} of {int(limits.output):,} bytes",
    )


GROUPS = (
    "this needs control groups that you may set: run it as root, or where groups of version 2 are "
    "delegated to you (`systemd-run --user --scope -p Delegate=yes wildscav …`)"
)


def _promise(name: str, kept: bool, found: str, remedy: str = "") -> Promise:
    return Promise(name, kept, found, "" if kept else remedy)


def _words(values: Any) -> str:
    return ", ".join(str(value) for value in values) or "none"


def _size(count: int) -> str:
    return f"{int(count) / MEBIBYTE:,.0f} MiB"
