"""What a check finds: whether a rule is kept, what was seen, and how to fix it."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from wildscav.server import Clock, SeatReport
from wildscav.wire.actions import MAX_WALK_SPEED
from wildscav_evaluator.matches.play import EXIT_TIME
from wildscav_evaluator.sandbox import Ending, Limits
from wildscav_evaluator.submissions.images import REQUIREMENTS

SLOW = 0.8  # of the budget; a median beyond it is too near to it


class Verdict(StrEnum):
    """What became of a check."""

    KEPT = "ok"
    DOUBTFUL = "warning"  # it plays, but probably not as its author intended
    BROKEN = "failed"


@dataclass(frozen=True)
class Finding:
    """One check and its verdict."""

    check: str
    verdict: Verdict
    seen: str  # in a line
    advice: str = ""  # how, if it is not kept
    last_lines: tuple[str, ...] = ()  # of what the agent printed


def judge_match(report: SeatReport, clock: Clock, limits: Limits, what: str) -> Iterator[Finding]:
    """Yield what a match tells of an agent: whether it started, spoke properly, and in time.

    Args:
        report: Of its seat.
        clock: That the match was played with.
        limits: Of the sandbox.
        what: Which match it was.
    """
    if report.start_up is not None:
        yield start_up(report.start_up, clock)
    if report.status != "finished":
        advice = advice_on(report.status.value, clock, limits)
        seen = f"{report.status.value}: {report.detail}"
        yield Finding(what, Verdict.BROKEN, seen, advice, report.last_lines)
        return
    yield Finding(what, Verdict.KEPT, f"{report.steps_played:,} steps played to the end")
    yield actions(report)
    yield timing(report, clock)


def packages(folder: Path) -> Finding:
    """Say that what a submission asks for was not installed, in a sandbox that installs nothing."""
    return Finding(
        "packages",
        Verdict.DOUBTFUL,
        f"{REQUIREMENTS} was not installed: it was played with the packages that this machine has",
        f"play it as a judge may: `wildscav build {folder}`, and check it again with --sandbox oci",
    )


def start_up(seconds: float, clock: Clock) -> Finding:
    """Judge how long an agent took to be ready."""
    seen = f"ready after {seconds:.1f} s of {clock.join_timeout:g} s"
    if seconds < clock.join_timeout / 2:
        return Finding("start-up", Verdict.KEPT, seen)
    return Finding(
        "start-up",
        Verdict.DOUBTFUL,
        seen,
        "on a busier machine it may be too late: import less, load smaller models, prepare files beforehand",
    )


def actions(report: SeatReport) -> Finding:
    """Judge what an agent's answers hold."""
    total, invalid = report.steps_played, report.invalid_actions
    if not invalid:
        note = f", {report.ignored_fields:,} fields ignored" if report.ignored_fields else ""
        return Finding("actions", Verdict.KEPT, f"{total:,} valid actions{note}")
    return Finding(
        "actions",
        # An agent that never acts plays as an empty seat does: that is no submission.
        Verdict.BROKEN if invalid == total else Verdict.DOUBTFUL,
        f"{invalid:,} of {total:,} actions were invalid and played as no action",
        f"send a walk_speed of 0 to {MAX_WALK_SPEED:g} m/s and angles that are finite numbers",
    )


def timing(report: SeatReport, clock: Clock) -> Finding:
    """Judge how long an agent took for its answers."""
    time, budget = report.think_time, clock.step_budget
    seen = (
        f"answers took {time.p50 * 1e3:.0f} ms in the median, {time.p99 * 1e3:.0f} ms at p99 and "
        f"{time.max * 1e3:.0f} ms at most; a step allows {budget * 1e3:.0f} ms; "
        f"{report.time_bank:.1f} s of {clock.time_bank:.1f} s left in the bank"
    )
    if time.p50 > SLOW * budget or report.time_bank < clock.time_bank / 2:
        return Finding(
            "timing",
            Verdict.DOUBTFUL,
            seen,
            "a slower machine would make it late, and a late step is played with no action: "
            "compute less a step, or watch observation.time_bank and answer sooner when little is left",
        )
    return Finding("timing", Verdict.KEPT, seen)


def process_exit(ending: Ending | None) -> Finding:
    """Judge how an agent's process ended once its match was over.

    Args:
        ending: None if it had to be stopped.
    """
    check, advice = "end", "let the process end, with exit code 0, once MatchOver has come"
    if ending is None:
        seen = f"its process was still there {EXIT_TIME:g} s after the match, and was stopped"
        return Finding(check, Verdict.DOUBTFUL, seen, f"{advice}; join or stop threads and children")
    if ending.exit_code == 0:
        return Finding(check, Verdict.KEPT, "its process ended by itself after the match")
    return Finding(check, Verdict.DOUBTFUL, str(ending), advice, ending.last_lines)


def lateness(report: SeatReport, limits: Limits, clock: Clock) -> Finding:
    """Judge how an agent bears that steps are played without it."""
    check = "late answers"
    if report.status in ("finished", "timed_out"):
        return Finding(check, Verdict.KEPT, f"it went on after {report.late_steps} steps without its answer")
    return Finding(
        check,
        Verdict.BROKEN,
        f"{report.status.value}: {report.detail}",
        "after a late answer the next observation skips steps: answer it with its own step number, and rely "
        f"on no step coming. {advice_on(report.status.value, clock, limits)}",
        report.last_lines,
    )


def cancelled_match(ending: Ending | None, waited: float) -> Finding:
    """Judge how an agent takes the end of its stream in the middle of a match."""
    if ending is not None:
        return Finding("cancelled match", Verdict.KEPT, str(ending))
    return Finding(
        "cancelled match",
        Verdict.DOUBTFUL,
        f"its process was still there {waited:g} s after the server had ended the stream",
        "end the process when the stream ends with an error status; do not try again for ever",
    )


def output(size: int, limits: Limits) -> Finding:
    """Judge how much an agent prints in a match."""
    seen = f"{size:,} of {limits.output:,} bytes printed"
    if size < limits.output:
        return Finding("output", Verdict.KEPT, seen)
    return Finding(
        "output", Verdict.DOUBTFUL, seen, "what comes after that is thrown away: print less in every step"
    )


def advice_on(status: str, clock: Clock, limits: Limits) -> str:
    """Return what an author can do about an outcome."""
    return {
        "timed_out": (
            f"each answer has {clock.step_budget * 1e3:.0f} ms and the match a bank of {clock.time_bank:g} s "
            "for all that is beyond: compute less a step, and watch observation.time_bank"
        ),
        "crashed": (
            "read its last lines; the agent's folder is read-only, only /tmp can be written, there is no "
            "network, and only what requirements.txt names is installed"
        ),
        "out_of_memory": (
            f"it may take {limits.memory / 2**20:.0f} MiB, what it writes into /tmp included: load smaller "
            "models, and do not keep every observation"
        ),
        "protocol_error": (
            "answer every Observation with one Action that has its step number, and send nothing else; "
            "the SDK does just that"
        ),
        "disqualified": "it went beyond a limit of its sandbox: do less of what the line above names",
        "never_joined": (
            f"within {clock.join_timeout:g} s it must connect to WILDSCAV_ADDRESS, send a Join with "
            "WILDSCAV_TOKEN, and be through with reset(): import less, load smaller models"
        ),
    }[status]
