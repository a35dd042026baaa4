"""`wildscav check`: what it tries with an agent, and how it explains what fails."""

import dataclasses
import json
import re
from contextlib import nullcontext
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Command, Submit
from tests.evaluator.small_matches import need, tiny_suite

from wildscav.errors import UserError
from wildscav_engine.maps import map_spec
from wildscav_engine.simulation.match import Match
from wildscav_evaluator.check.findings import Finding, Verdict, advice_on
from wildscav_evaluator.check.trials import Tell, Trial, run_checks
from wildscav_evaluator.cli.sessions import check as checking
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Limits
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.suite import EVALUATION_MAPS, SUITES, Suite
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_server.hosting.observations import match_info
from wildscav_server.time_limits import Clock

pytestmark = pytest.mark.usefixtures("compiled")

PATIENT = Clock(step_budget=2.0)  # so that a busy machine is not the agent's fault
HASTY = Clock(step_budget=0.02, time_bank=0.5)
PUNCTUAL = Clock(join_timeout=2.0)
MATCH = "match: navigation"
CHECKS = ["start-up", MATCH, "actions", "timing", "output", "end", "late answers", "cancelled match"]


def findings(
    submission: Submission,
    logs: Path,
    clock: Clock = PATIENT,
    tell: Tell = print,
    suite: Suite = SUITES["quick"],
) -> dict[str, Finding]:
    trials = {"navigation": Trial.of(suite, "navigation", DEFAULT_LIMITS, seed=0)}
    found = list(run_checks(submission, SANDBOXES["process"], logs, trials, clock=clock, tell=tell))
    return {finding.check: finding for finding in found}


@pytest.fixture
def short(tmp_path: Path) -> Suite:
    """A suite of one match of six seconds."""
    return read_suite(tiny_suite(tmp_path, maps=1, seconds=6))


def test_an_agent_that_keeps_the_rules_passes_every_check(submit: Submit, tmp_path: Path) -> None:
    told: list[str] = []
    found = findings(submit("walker", WALKER), tmp_path / "logs", tell=told.append)

    assert list(found) == CHECKS
    lines = [re.fullmatch(r"(.+): \d+ of (\d+) steps played", line) for line in told]
    assert {(line[1], line[2]) for line in lines if line} == {(MATCH, "600"), ("late answers", "50")}
    assert len(told) >= 5, "a line every second"
    assert {finding.verdict for finding in found.values()} == {Verdict.KEPT}, found
    went_on = re.fullmatch(r"it continued after (\d+) steps without its answer", found["late answers"].seen)
    assert went_on is not None
    assert int(went_on[1]) > 10  # however quick it is


LONG = """
name = "long"
map = { size = 40, houses = 0 }
[tracks.navigation]
maps = 1
match = { time_limit = 300.0, seats = ["submission", "submission"] }
limits = { memory = "256MiB" }
"""
# Writes down what it is told, and stays where it is.
TELLER = """
    def reset(self, match):
        import dataclasses, json
        print(json.dumps(dataclasses.asdict(match)), flush=True)

    def act(self, observation):
        return Action()
"""


@pytest.mark.slow
def test_a_match_ends_early_and_its_agents_are_told_what_the_suite_says(
    submit: Submit, tmp_path: Path
) -> None:
    (tmp_path / "long.toml").write_text(LONG)
    suite = read_suite(tmp_path / "long.toml")
    # A seed whose target is not where somebody starts, which ends the match at once.
    trials = {"navigation": Trial.of(suite, "navigation", suite.limits["navigation"], seed=0)}

    found = list(run_checks(submit("teller", TELLER), SANDBOXES["process"], tmp_path, trials))

    assert {one.verdict for one in found} == {Verdict.KEPT}, found
    assert found[1].seen == "600 steps played to the end"
    (scored,) = suite.matches("navigation", seed=0)
    told = [json.loads(path.read_text().splitlines()[0]) for path in sorted(tmp_path.glob("*.log"))]
    assert len(told) == 6  # two agents in three matches
    expected = {seat: match_info(Match(scored), seat, Clock().fitted(scored)) for seat in (0, 1)}
    for one in told:
        kept = {name: one[name] for name in one if name not in ("seed", "start", "target", "supply_waves")}
        assert kept.items() <= dataclasses.asdict(expected[one["seat"]]).items()


@pytest.mark.slow
def test_an_agent_that_needs_more_memory_than_the_suite_allows_fails(submit: Submit, tmp_path: Path) -> None:
    need("bubblewrap")
    big = submit("big", "    def reset(self, match): self.table = bytes(b'x' * (300 << 20))\n" + WALKER)
    trial = Trial.of(SUITES["quick"], "navigation", Limits.model_validate({"memory": "256MiB"}))

    found = run_checks(big, SANDBOXES["bubblewrap"], tmp_path / "logs", {"navigation": trial})
    match = next(one for one in found if one.check == MATCH)

    assert match.verdict == Verdict.BROKEN
    assert match.seen.startswith("out_of_memory")
    assert "it may use 256 MiB" in match.advice


def test_a_fresh_match_is_on_no_map_of_the_suite_and_differs_each_time(tmp_path: Path) -> None:
    (tmp_path / "known.toml").write_text('name = "known"\n[tracks.navigation]\nmaps = [1, 2]\n')
    suite = read_suite(tmp_path / "known.toml")
    known = [map_spec(1), map_spec(2)]

    fresh = [Trial.of(suite, "navigation", DEFAULT_LIMITS).spec for _ in range(8)]

    assert len({spec.seed for spec in fresh}) == len({spec.map.seed for spec in fresh}) == 8
    assert all(spec.map.seed >= EVALUATION_MAPS for spec in fresh)
    assert all(spec.map.config in [one.config for one in known] for spec in fresh)
    public = Trial.of(suite, "navigation", DEFAULT_LIMITS, seed=0).spec
    assert public == suite.matches("navigation", 0)[0]


@pytest.mark.parametrize(
    ("requirements", "missing"),
    [
        ("", ""),
        ("# nothing\nnumpy>=1  # this machine has it\nwildscav\nno-such-package; python_version < '3'", ""),
        ("numpy\nno-such-package==1\n", "'no-such-package==1'"),
        ("numpy>=999", "'numpy>=999'"),
        ("-r others.txt\n", "'-r others.txt'"),
    ],
)
def test_packages_that_the_sandbox_lacks_are_named_before_anything_is_played(
    submit: Submit, tmp_path: Path, requirements: str, missing: str
) -> None:
    submission = submit("walker", WALKER)
    (submission.folder / "requirements.txt").write_text(requirements)

    first = next(run_checks(submission, SANDBOXES["process"], tmp_path / "logs", {}, clock=PATIENT))

    assert (first.check, first.verdict) == ("packages", Verdict.BROKEN if missing else Verdict.KEPT)
    assert f"names {missing}, which this machine does not have" in first.seen or not missing


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "body", "clock", "seen", "advice"),
    [
        ("crasher", "    def act(self, o): raise ValueError('oh')", HASTY, "ValueError: oh", "read-only"),
        ("sleeper", "    def act(self, o): time.sleep(60)", HASTY, "timed_out", "a bank of 0.5 s"),
        ("late", "    def reset(self, match): time.sleep(60)", PUNCTUAL, "get ready", "within 2 s"),
    ],
)
def test_an_agent_that_cannot_play_is_told_why_and_what_to_do(
    *,
    submit: Submit,
    short: Suite,
    tmp_path: Path,
    name: str,
    body: str,
    clock: Clock,
    seen: str,
    advice: str,
) -> None:
    found = findings(submit(name, body), tmp_path / "logs", clock, suite=short)

    assert found[MATCH].verdict == Verdict.BROKEN
    assert seen in found[MATCH].seen
    assert advice in found[MATCH].advice
    assert "late answers" not in found  # what cannot play fails the rest for the same reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "check", "verdict", "seen"),
    [
        (
            "    def act(self, o): return Action(walk_speed=99.0 * (o.step % 2))",
            *("actions", Verdict.DOUBTFUL, "actions were invalid"),
        ),
        (
            "    def act(self, o): return Action(walk_speed=99.0)",
            *("actions", Verdict.BROKEN, "60 of 60 actions were invalid"),
        ),
        (
            "    def act(self, o): print('x' * 100_000); return Action()",
            *("output", Verdict.DOUBTFUL, "of 1,000,000 bytes"),
        ),
        (
            """
    def act(self, observation):
        if observation.step == 0:
            import threading
            threading.Thread(target=time.sleep, args=(60,)).start()
        return Action()
""",
            *("end", Verdict.DOUBTFUL, "s after the match, and was stopped"),
        ),
        (
            """
    def act(self, observation):
        self.steps = getattr(self, "steps", -1) + 1
        if self.steps != observation.step:
            os._exit(5)
        return Action()
""",
            *("late answers", Verdict.BROKEN, "exit code 5"),
        ),
    ],
    ids=["fast", "never valid", "loud", "clinging", "counting"],
)
def test_what_is_not_as_it_should_be_is_named(
    submit: Submit, short: Suite, tmp_path: Path, body: str, check: str, verdict: Verdict, seen: str
) -> None:
    found = findings(submit("agent", body), tmp_path / "logs", suite=short)

    assert found[MATCH].verdict == Verdict.KEPT
    assert found[check].verdict == verdict
    assert seen in found[check].seen
    assert found[check].advice


@pytest.mark.parametrize("verdict", Verdict)
def test_what_breaks_no_rule_may_be_submitted(
    submit: Submit,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    verdict: Verdict,
) -> None:
    found = [Finding("actions", verdict, "what was seen", "advice")]
    monkeypatch.setattr(checking, "run_checks", lambda *_, **__: found)
    broken = verdict == Verdict.BROKEN

    with pytest.raises(UserError, match="agent fails 1 check") if broken else nullcontext() as refused:
        checking.run_check(submit("agent", WALKER), SANDBOXES["process"], tmp_path, {})

    assert refused is None or refused.value.exit_code == 1
    assert ("may be submitted" in capsys.readouterr().out) != broken


def test_every_outcome_has_a_way_to_mend_it() -> None:
    from wildscav_server.hosting.reports import SeatStatus

    for status in SeatStatus:
        if status != "finished":
            advice = advice_on(status.value, Clock(), DEFAULT_LIMITS)
            assert advice, status
            assert "last lines" not in advice  # an agent that just exits has none


def test_the_command_tells_all_and_its_exit_code_says_the_same(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    crasher = submit("crasher", "    def act(self, observation): return 1 / 0")

    done = wildscav("check", crasher.folder, "--sandbox=process", "--logs", tmp_path / "logs")

    assert done.returncode == 1
    assert "crasher fails 1 check" in done.stderr
    assert "ZeroDivisionError" in done.stdout
    assert "to fix it: " in done.stdout
    assert "Traceback" not in done.stderr
