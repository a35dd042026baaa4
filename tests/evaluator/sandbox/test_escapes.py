"""The escape suite: each attack works without a sandbox, and none works in one."""

import os
import re
import signal
import sys
from pathlib import Path

import pytest
from tests.evaluator.sandbox.sandbox_runs import FLOOD, LIMITS, Report, attack

from wildscav_evaluator.sandbox import Sandbox
from wildscav_server import leftovers

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the attacks are on Linux")
TABLE = (Path(__file__).parent / "attacker" / "agent.py").read_text("utf-8").partition("ATTACKS: ")[2]
ATTACKS = re.findall(r'^    "(\w+)": ', TABLE, re.MULTILINE)
# What a user other than root cannot do to others anyway.
ROOTS = {"files_make_a_device", "files_write_kernel_settings", "kernel_mount", "kernel_become_root"}


@pytest.fixture(scope="module")
def unprotected() -> Report:
    report = attack("process")
    assert set(report.worked) == set(ATTACKS)
    for process in report.survivors:
        os.kill(process, signal.SIGKILL)
    return report


@pytest.fixture(scope="module")
def sandboxed(real: Sandbox) -> Report:
    report = attack(real.name)
    assert set(report.worked) == set(ATTACKS)
    return report


@pytest.mark.parametrize("name", ATTACKS)
def test_the_attack_works_without_a_sandbox(name: str, unprotected: Report) -> None:
    if os.getuid() != 0 and name in ROOTS:
        pytest.skip("it takes root")
    assert unprotected.worked[name], unprotected.details[name]


@pytest.mark.parametrize("name", ATTACKS)
def test_no_attack_works_in_a_sandbox(name: str, sandboxed: Report) -> None:
    assert not sandboxed.worked[name], f"{name} worked"


def test_without_a_sandbox_daemons_outlive_the_match_and_code_can_be_changed(unprotected: Report) -> None:
    assert unprotected.survivors
    assert unprotected.written


def test_nothing_is_left_of_a_sandboxed_agent(sandboxed: Report) -> None:
    assert sandboxed.survivors == []
    assert not sandboxed.written
    assert list(Path("/sys/fs/cgroup").glob(f"**/wildscav-{leftovers.owner()}-*")) == []


def test_a_flood_of_output_ends_at_the_limit(sandboxed: Report) -> None:
    assert 10 * LIMITS.output < FLOOD
    assert sandboxed.log_size < LIMITS.output + 100
    assert sandboxed.ending.exit_code == 7  # it got through with its flood, and was not held up for long
