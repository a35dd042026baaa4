"""The four clocks, with real agents: their records hold, and rows of different clocks are not compared."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import plan_of
from tests.evaluator.sample_agents import Submit
from tests.evaluator.small_matches import tiny_suite
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_engine.record import read_record, verify_record
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.cli.options.selection import clock_choice
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.output.identity import read_identity
from wildscav_evaluator.output.record_names import record_paths
from wildscav_evaluator.output.results import read_results
from wildscav_evaluator.scores.compare import changes_since_last
from wildscav_evaluator.scores.leaderboard import standings
from wildscav_evaluator.suites.suite_file import read_suite

# Thinks for 20 ms of a processor in each step.
THINKER = """
    def act(self, observation):
        end = time.process_time() + 0.02
        while time.process_time() < end:
            pass
        return Action(walk_direction=observation.step * 10.0, walk_speed=6.0)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "clock",
    ["bank", "paused,budget=60", "running,pace=5", "tokens,processor_time=11"],
    ids=lambda one: one[:6],
)
def test_verify_and_rescore_agree(
    clock: str, tmp_path: Path, submit: Submit, warm_workers: WarmWorkers, capsys: pytest.CaptureFixture[str]
) -> None:
    out, chosen = tmp_path / "out", clock_choice(clock)
    suite = replace(read_suite(tiny_suite(tmp_path, maps=1)), clock=chosen)
    with playing_with(warm_workers):
        run_session(plan_of(submit("thinker", THINKER), out=out, suite=suite, jobs=1))
    run_rescore(out, LocalExecutor(1))
    assert "1 record played again: all agree" in capsys.readouterr().out

    results, identity = read_results(out / "results.json"), read_identity(out)
    assert identity is not None
    assert results.clock == identity.clock == chosen
    (timing,) = results.timings.matches[0].seats
    record = read_record(record_paths(out)[0])
    assert (record.spec.clock, record.spec.thinking) == (chosen.clock, chosen.thinking)
    assert verify_record(record).holds
    if chosen.clock in ("bank", "paused"):
        assert (timing.steps, timing.held_steps) == (record.steps, 0)
        return
    assert record.thinking is not None
    assert record.thinking.seats[0].held == timing.held_steps
    if chosen.clock == "running":
        assert timing.steps + timing.held_steps == record.steps
        assert timing.late_steps == 0
        return
    assert timing.processor >= 0.02 * (timing.steps - 1)
    assert timing.held_steps >= 2 * (timing.steps - 1)  # each thought costs 0.22 s of game time, or more
    record.thinking.charges[0, 4] -= 1
    assert "its thought costs" in verify_record(record).message


def test_rows_of_different_clocks_are_neither_compared_nor_ranked_together(
    tmp_path: Path, submit: Submit
) -> None:
    suite, submission = read_suite(tiny_suite(tmp_path, maps=1)), submit("thinker", THINKER)
    plans = [
        plan_of(submission, out=tmp_path / str(pace), suite=replace(suite, clock=one))
        for pace in (1, 2)
        for one in [ClockChoice.model_validate({"clock": "running", "thinking": {"pace": pace}})]
    ]
    slow, fast = (plan.collect([]) for plan in plans)
    assert plans[0].identity() != plans[1].identity()
    assert [one.conditions.clock for one in standings([slow, fast])] == [
        "running (1 game s per s)",
        "running (2 game s per s)",
    ]
    assert changes_since_last(fast, tmp_path / "2") == ()
    assert plans[1].title.startswith("suite tiny@")
    assert "clock running (2 game s per s)" in plans[1].title


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("stopped", "Input should be 'bank', 'paused', 'running' or 'tokens'"),
        ("bank,pace=2", "thinking.pace is given, but the clock bank does not use it"),
        ("running,pace=0", "greater than or equal to 0.001"),
        ("running,pace=quick", "Input should be a valid number"),
        ("running,2", "every part must be NAME=NUMBER"),
        ("tokens,price=3", "Extra inputs are not permitted"),
    ],
)
def test_a_clock_that_there_is_not_is_refused(text: str, fault: str) -> None:
    with pytest.raises(UserError, match=f"--clock {text}: .*{fault}"):
        clock_choice(text)
