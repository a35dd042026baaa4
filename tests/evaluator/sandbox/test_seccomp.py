"""The policy of system calls: the same for bubblewrap and for containers, and nothing dangerous in it."""

import pytest

from wildscav_evaluator.sandbox import SandboxError
from wildscav_evaluator.sandbox.seccomp import ALLOWED, EXACTLY, REFUSED, bpf_filter, container_profile


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
        for rule in container_profile()["syscalls"]
        if rule["action"] == "SCMP_ACT_ALLOW"
        for name in rule["names"]
    }

    assert name not in allowed
    assert container_profile()["defaultAction"] == "SCMP_ACT_ERRNO"


def test_the_filter_is_a_program_of_the_kernels_machine() -> None:
    try:
        program = bpf_filter()
    except SandboxError as error:
        pytest.skip(str(error))

    assert len(program) % 8 == 0  # eight bytes an instruction
    assert 100 < len(program) // 8 < 4096  # the kernel takes no more
