"""An agent's waits for a processor: what others cost it counts, and never what it costs itself."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from wildscav_evaluator.sandbox import SandboxError
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS
from wildscav_evaluator.sandbox.linux.cgroup import AgentGroup, CountedGroup, find_version, meter_of
from wildscav_evaluator.sandbox.processor_waits import GroupMeter, Reading, waited_for_others

BUSY = "import os\nos.sched_setaffinity(0, {core})\nprint('ready', flush=True)\nwhile True: pass"
NOTHING = Reading(0.0, 0.0, 0.0, {1: (0.0, 0.0), 2: (0.0, 0.0)})


@pytest.mark.parametrize(
    ("ran", "held_back", "leaders", "credit"),
    [
        (0.1, 0.0, {1: (0.1, 0.4)}, 0.4),  # it ran alone: all of its wait is the work of others
        (0.5, 0.0, {1: (0.25, 0.25), 2: (0.25, 0.25)}, 0.0),  # its two processes took turns
        (0.5, 0.0, {1: (0.1, 0.4)}, 0.0),  # children that have ended, or threads, ran meanwhile
        (0.2, 0.0, {1: (0.1, 0.4)}, 0.3),  # they ran for a part of it
        (0.1, 0.4, {1: (0.1, 0.4)}, 0.0),  # its own limit held it back
        (0.1, 0.0, {1: (0.05, 0.3), 2: (0.05, 0.4)}, 0.35),  # the one that waited longest counts
        (0.1, 0.0, {1: (0.1, 0.1), 3: (0.0, 0.4)}, 0.1),  # one that is new has no beginning
        (0.0, 0.0, {1: (0.0, 9.0)}, 0.5),  # no more than the time that passed
    ],
)
def test_only_what_others_work_explains_counts(
    ran: float, held_back: float, leaders: dict[int, tuple[float, float]], credit: float
) -> None:
    assert waited_for_others(NOTHING, Reading(0.5, ran, held_back, leaders)) == pytest.approx(credit)


@pytest.fixture
def group() -> Iterator[AgentGroup]:
    """A control group on this machine."""
    try:
        made = AgentGroup(find_version(), DEFAULT_LIMITS)
    except SandboxError as error:
        pytest.skip(str(error))
    yield made
    made.kill()
    made.remove()


@contextmanager
def busy(core: int, entrances: tuple[Path, ...] = ()) -> Iterator[None]:
    """Keep a core busy by a process, in a control group."""
    code = BUSY.format(core="{" + str(core) + "}")
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    try:
        for entrance in entrances:
            entrance.write_text(str(process.pid))
        assert process.stdout is not None
        process.stdout.readline()
        yield
    finally:
        process.kill()
        process.communicate()


def test_an_agent_that_shares_its_core_with_others_is_seen_to_wait(group: AgentGroup) -> None:
    meter = meter_of(group.counted)
    if meter is None:
        pytest.skip("the kernel does not count waiting")
    core = min(os.sched_getaffinity(0))
    with busy(core, tuple(group.entrances)), busy(core):
        meter.find_processes()
        meter.start()
        while meter.waited() < 0.5:  # however slowly
            time.sleep(0.05)
    meter.close()
    assert meter.waited() == 0.0  # nothing is measured any more


def test_a_group_that_does_not_count_cannot_be_measured(tmp_path: Path) -> None:
    nowhere = CountedGroup({"memory": tmp_path})

    with pytest.raises(OSError, match="does not count"):
        GroupMeter(nowhere)
    assert meter_of(nowhere) is None


def test_a_group_whose_counters_are_cut_short_is_gone(tmp_path: Path) -> None:
    counters = tmp_path / "cpu.stat"
    counters.write_text("usage_usec 1500000\nthrottled_usec 0\n")
    meter = GroupMeter(CountedGroup({"memory": tmp_path}))
    assert meter.ran() == 1.5
    counters.write_text("usage_usec")

    with pytest.raises(OSError, match="does not count"):
        meter.ran()
    meter.close()


def test_each_version_has_its_own_counters(tmp_path: Path) -> None:
    one = CountedGroup({"cpu": tmp_path, "memory": tmp_path, "cpuacct": tmp_path / "cpuacct"})
    two = CountedGroup({"memory": tmp_path})

    assert one.counters == (tmp_path / "cpu.stat", tmp_path / "cpuacct" / "cpuacct.usage")
    assert one.used([b"nr_periods 5\nthrottled_time 2000000000\n", b"1500000000\n"]) == (1.5, 2.0)
    assert two.counters == (tmp_path / "cpu.stat",)
    assert two.used([b"usage_usec 1500000\nthrottled_usec 2000000\n"]) == (1.5, 2.0)
