"""What the kernel does for sandboxes: users, the policy of system calls, and memory kills."""

import fcntl
import itertools
import os
from pathlib import Path

import pytest

from wildscav_evaluator.sandbox import SandboxError
from wildscav_evaluator.sandbox.base import MemoryKill
from wildscav_evaluator.sandbox.limits import MEBIBYTE
from wildscav_evaluator.sandbox.linux.cgroup import Version1, Version2
from wildscav_evaluator.sandbox.linux.kernel_log import read_kill
from wildscav_evaluator.sandbox.linux.seccomp import (
    ALLOWED,
    EXACTLY,
    LOCK_COMMANDS,
    REFUSED,
    bpf_filter,
    container_profile,
)
from wildscav_evaluator.sandbox.linux.users import AT_ONCE, OWN_USERS, agent_user


@pytest.mark.parametrize("process", [1, 2_097_152, 4_194_303])  # the last is the highest that Linux gives
def test_every_process_has_users_of_its_own_that_container_engines_take(
    monkeypatch: pytest.MonkeyPatch, process: int
) -> None:
    monkeypatch.setattr(os, "getpid", lambda: process)

    users = {agent_user() for _ in range(AT_ONCE)}

    assert users == {OWN_USERS + process * AT_ONCE + slot for slot in range(AT_ONCE)}
    assert max(users) < 2**31


def test_nothing_is_both_allowed_and_refused() -> None:
    assert ALLOWED.isdisjoint(REFUSED)
    assert ALLOWED.isdisjoint(EXACTLY)


def test_what_gets_agents_out_is_not_allowed() -> None:
    profile = container_profile(locks=True)
    allowed = [rule["names"] for rule in profile["syscalls"] if rule["action"] == "SCMP_ACT_ALLOW"]
    out = "unshare setns mount ptrace process_vm_readv keyctl bpf io_uring_setup clone3 inotify_init1"

    assert {*out.split()}.isdisjoint(itertools.chain(*allowed))
    assert profile["defaultAction"] == "SCMP_ACT_ERRNO"


@pytest.mark.parametrize(("locks", "action"), [(False, "SCMP_ACT_ERRNO"), (True, "SCMP_ACT_ALLOW")])
def test_files_are_locked_only_by_who_shares_none(locks: bool, action: str) -> None:
    rules = container_profile(locks=locks)["syscalls"]

    flock = [rule["action"] for rule in rules if "flock" in rule["names"]]
    commands = {rule["args"][0]["value"]: rule["action"] for rule in rules if rule["names"] == ["fcntl"]}

    assert flock == [action]
    assert {commands[command] for command in LOCK_COMMANDS} == {action}
    assert commands[fcntl.F_GETFL] == "SCMP_ACT_ALLOW"


def test_the_filter_is_a_program_of_the_kernels_machine() -> None:
    try:
        program = bpf_filter()
    except SandboxError as error:
        pytest.skip(str(error))

    assert len(program) % 8 == 0  # eight bytes an instruction
    assert 100 < len(program) // 8 < 4096  # the kernel takes no more


EVENTS = "low 0\nhigh 0\nmax {stops}\noom {oom}\noom_kill {kills}\noom_group_kill 0\n"
CONTROL = "oom_kill_disable 0\nunder_oom 0\noom_kill {kills}\n"
OURS, OTHERS = "5f" * 32, "a0" * 32
RECORD = "6,1742,71126008753,-;oom-kill:constraint={constraint},nodemask=(null),cpuset={ours},mems_allowed=0,"
VICTIM = ",task=python,pid=31012,uid=1881252259\n"


@pytest.mark.parametrize(
    ("stops", "oom", "kills", "kill"),
    [
        (0, 0, 0, MemoryKill.NONE),
        (9, 0, 0, MemoryKill.NONE),  # it was at its limit, and room could be made
        (9, 1, 1, MemoryKill.OWN),
        (0, 0, 1, MemoryKill.MACHINES),
        (9, 0, 1, MemoryKill.MACHINES),  # room could be made when it was at its limit
    ],
)
def test_what_version_2_counts(stops: int, oom: int, kills: int, kill: MemoryKill, tmp_path: Path) -> None:
    (tmp_path / "memory.events").write_text(EVENTS.format(stops=stops, oom=oom, kills=kills))

    assert Version2({"memory": tmp_path}).memory_kill(tmp_path) is kill


@pytest.mark.parametrize(
    ("most", "with_swap", "kills", "kill"),
    [
        (40, 40, 0, MemoryKill.NONE),
        (256, 256, 0, MemoryKill.NONE),  # it was at its limit, and room could be made
        (256, 256, 1, MemoryKill.OWN),
        (200, 256, 1, MemoryKill.OWN),  # some of it was swapped out
        (256, None, 1, MemoryKill.OWN),  # a kernel that does not account for swap
        (200, 200, 1, MemoryKill.MACHINES),
        (200, None, 1, MemoryKill.MACHINES),
    ],
)
def test_what_version_1_counts(
    most: int, with_swap: int | None, kills: int, kill: MemoryKill, tmp_path: Path
) -> None:
    (tmp_path / "memory.oom_control").write_text(CONTROL.format(kills=kills))
    (tmp_path / "memory.limit_in_bytes").write_text(f"{256 * MEBIBYTE}\n")
    (tmp_path / "memory.max_usage_in_bytes").write_text(f"{most * MEBIBYTE}\n")
    if with_swap is not None:
        (tmp_path / "memory.memsw.max_usage_in_bytes").write_text(f"{with_swap * MEBIBYTE}\n")

    assert Version1({"memory": tmp_path}).memory_kill(tmp_path) is kill


@pytest.mark.parametrize(
    ("constraint", "groups", "kill"),
    [
        ("MEMCG", f"oom_memcg=/docker/{OURS},task_memcg=/docker/{OURS}", MemoryKill.OWN),
        # crun and systemd have the processes in a group of the one with the limit
        ("MEMCG", f"oom_memcg=/m/libpod-{OURS}.scope,task_memcg=/m/libpod-{OURS}.scope/c", MemoryKill.OWN),
        ("MEMCG", f"oom_memcg=/docker,task_memcg=/docker/{OURS}", MemoryKill.MACHINES),
        ("NONE", f"global_oom,task_memcg=/docker/{OURS}", MemoryKill.MACHINES),
        ("MEMCG", f"oom_memcg=/docker/{OTHERS},task_memcg=/docker/{OTHERS}", MemoryKill.NONE),
        ("NONE", f"global_oom,task_memcg=/docker/{OTHERS}", MemoryKill.NONE),
    ],
)
def test_what_the_kernels_log_says(constraint: str, groups: str, kill: MemoryKill) -> None:
    record = RECORD.format(constraint=f"CONSTRAINT_{constraint}", ours=OURS) + groups + VICTIM

    assert read_kill(record.encode(), OURS) is kill
