"""The policy of system calls: the same for bubblewrap and for containers, and nothing dangerous in it."""

import fcntl

import pytest

from wildscav_evaluator.sandbox import SandboxError
from wildscav_evaluator.sandbox.linux.seccomp import (
    ALLOWED,
    EXACTLY,
    LOCK_COMMANDS,
    REFUSED,
    bpf_filter,
    container_profile,
)


def test_nothing_is_both_allowed_and_refused() -> None:
    assert ALLOWED.isdisjoint(REFUSED)
    assert ALLOWED.isdisjoint(EXACTLY)


@pytest.mark.parametrize(
    "name",
    [
        "unshare",
        "setns",
        "mount",
        "ptrace",
        "process_vm_readv",
        "keyctl",
        "bpf",
        "io_uring_setup",
        "clone3",
        "inotify_init1",
    ],
)
def test_what_gets_agents_out_is_not_allowed(name: str) -> None:
    allowed = {
        name
        for rule in container_profile(locks=True)["syscalls"]
        if rule["action"] == "SCMP_ACT_ALLOW"
        for name in rule["names"]
    }

    assert name not in allowed
    assert container_profile(locks=True)["defaultAction"] == "SCMP_ACT_ERRNO"


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
