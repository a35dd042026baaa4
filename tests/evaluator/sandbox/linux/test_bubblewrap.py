"""Bubblewrap refuses to start where it cannot keep its promises, and leaves nothing behind when it does."""

from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox.sandbox_runs import LIMITS, run_agent
from tests.evaluator.small_matches import need

from wildscav_evaluator.sandbox import SANDBOXES, SandboxError
from wildscav_evaluator.sandbox.linux import cgroup
from wildscav_server import leftovers


@pytest.fixture(autouse=True)
def _there() -> None:
    need("bubblewrap")


def test_without_control_groups_nothing_starts(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mountinfo").write_text("")
    monkeypatch.setattr(cgroup, "MOUNTS", tmp_path / "mountinfo")

    with pytest.raises(SandboxError, match="no limits on memory, processes and CPU: no control groups"):
        run_agent(SANDBOXES["bubblewrap"], submit("plain"), tmp_path)


def test_a_limit_that_the_kernel_does_not_take_is_named(submit: Submit, tmp_path: Path) -> None:
    limits = LIMITS.model_copy(update={"cpus": 1e9})

    with pytest.raises(SandboxError, match=r"a limit cannot be kept: .*cpu.* does not take"):
        run_agent(SANDBOXES["bubblewrap"], submit("plain"), tmp_path, limits)
    assert_no_groups()


def test_without_bubblewrap_it_says_what_to_install(
    submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))

    with pytest.raises(SandboxError, match=r"install it \(package bubblewrap\)"):
        run_agent(SANDBOXES["bubblewrap"], submit("plain"), tmp_path)


def test_a_start_that_fails_is_no_fault_of_the_agent_and_leaves_nothing(
    submit: Submit, tmp_path: Path
) -> None:
    limits = LIMITS.model_copy(update={"open_files": 10**9})  # beyond what the kernel has

    with pytest.raises(SandboxError, match="bubblewrap could not start"):
        run_agent(SANDBOXES["bubblewrap"], submit("plain"), tmp_path, limits)
    assert_no_groups()


def test_the_root_is_nobodys_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Users of containers often have none, and agents have a root of their own."""
    monkeypatch.setenv("HOME", "/")

    broken = [promise for promise in SANDBOXES["bubblewrap"].promises(LIMITS) if not promise.kept]

    assert broken == []


def assert_no_groups() -> None:
    assert list(Path("/sys/fs/cgroup").glob(f"**/{cgroup.PREFIX}{leftovers.owner()}-*")) == []
