"""Whose want of memory an agent was killed for: its own, or the machine's."""

from pathlib import Path

import pytest

from wildscav_evaluator.sandbox.base import MemoryKill
from wildscav_evaluator.sandbox.limits import MEBIBYTE
from wildscav_evaluator.sandbox.linux.cgroup import Version1, Version2
from wildscav_evaluator.sandbox.linux.kernel_log import read_kill

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
