"""Late steps are the platform's fault where the agent waited for a processor, and else its own."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from wildscav.server import Clock, SlowAnswer
from wildscav_evaluator.matches.lateness import late_for_platform
from wildscav_evaluator.sandbox.agents.processor_waits import Sample, WaitMeter
from wildscav_evaluator.scores.notes import lateness_note

CLOCK = Clock(step_budget=0.1, time_bank=1.0)
# Steps 4 to 6 were played while the answer to step 4 was under way, which took 1.4 s.
SLOW = SlowAnswer(step=4, asked=10.0, answered=11.4)


def nothing(start: float, end: float) -> float:
    return 0.0


def judge(*slow_answers: SlowAnswer, waited: float, used_up: bool = True) -> tuple[int, ...]:
    return late_for_platform([4, 5, 6], slow_answers, CLOCK, lambda start, end: waited, used_up=used_up)


def test_steps_are_the_platforms_where_the_wait_makes_the_difference() -> None:
    assert judge(SLOW, waited=0.5) == (4, 5, 6)  # 0.9 s of its own: 0.1 s of budget and 0.8 s of its bank


def test_steps_are_the_agents_where_it_was_too_slow_besides() -> None:
    assert judge(SLOW, waited=0.2) == ()
    assert judge(SLOW, waited=0.0) == ()


def test_what_was_thought_before_has_used_the_bank() -> None:
    before = SlowAnswer(step=2, asked=8.0, answered=8.9)
    assert judge(before, SLOW, waited=0.3) == ()  # 0.5 s of the bank, then 1.0 s


def test_an_agent_that_never_answers_is_late_by_itself() -> None:
    never = SlowAnswer(step=5, asked=20.0, answered=30.0)  # as the match ended
    assert judge(never, waited=0.5) == ()
    # Nor does an answer that was late before for want of a processor excuse it.
    waits = {SLOW.asked: 0.5, never.asked: 0.0}
    assert late_for_platform(
        [4, 5, 6], [SLOW, never], CLOCK, lambda start, end: waits[start], used_up=True
    ) == (4,)


def test_where_the_match_had_no_more_time_the_bank_does_not_count() -> None:
    assert judge(SLOW, waited=0.5, used_up=False) == ()
    assert judge(SLOW, waited=1.35, used_up=False) == (4, 5, 6)


def test_the_late_steps_are_named_in_a_line() -> None:
    line = lateness_note("ann", {"match 0: ": (4, 5, 6, 9), "match 2: ": (1,)})

    assert line.startswith("ann: 5 late steps were the machine's fault")
    assert "(match 0: steps 5–7, 10; match 2: step 2)" in line


BUSY = "import os\nos.sched_setaffinity(0, {core})\nprint('ready', flush=True)\nwhile True: pass"


def busy(core: int) -> "subprocess.Popen[str]":
    code = BUSY.format(core="{" + str(core) + "}")
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.readline()
    return process


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="the kernel does not count waiting")
def test_a_process_that_shares_its_core_is_seen_to_wait() -> None:
    core = min(os.sched_getaffinity(0))
    first, second = busy(core), busy(core)  # they want the same one
    try:
        meter = WaitMeter(lambda: [first.pid], cpus=1.0)
        meter.take()
        start = time.monotonic()
        # However slowly: until the other one has had a second of the core's time.
        while meter.waited(start, time.monotonic()) < 1.0:
            time.sleep(0.1)
            meter.take()
    finally:
        for process in (first, second):
            process.kill()
            process.communicate()


def test_an_agent_that_queues_behind_itself_or_uses_its_limit_up_lacks_nothing() -> None:
    half = Sample(main_ran=0.25, main_waited=0.25, ran=0.25)
    starved = Sample(main_ran=0.1, main_waited=0.4, ran=0.1)

    assert WaitMeter(list, cpus=1.0)._processor_wait([half, half], 0.5) == 0.0
    assert WaitMeter(list, cpus=0.2)._processor_wait([starved], 0.5) == 0.0
    assert WaitMeter(list, cpus=1.0)._processor_wait([starved], 0.5) == 0.4
