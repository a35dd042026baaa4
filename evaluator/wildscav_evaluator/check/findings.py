"""The findings of a check: whether a rule is kept, what was observed, and how to fix it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from wildscav.wire.actions import MAX_WALK_SPEED
from wildscav_evaluator.matches.play import EXIT_TIME
from wildscav_evaluator.sandbox import Ending, Limits
from wildscav_evaluator.submissions.images import REQUIREMENTS
from wildscav_server.hosting.reports import SeatReport
from wildscav_server.time_limits import Clock

SHOWN_REQUIREMENTS, LONGEST_REQUIREMENT = 3, 80  # lines, and characters of each
SLOW = 0.8  # share of the step budget; a median answer time above it is too close to the budget


class Verdict(StrEnum):
    """The outcome of a check."""

    KEPT = "ok"
    DOUBTFUL = "warning"  # it plays, but probably not as its author intended
    BROKEN = "failed"


@dataclass(frozen=True)
class Finding:
    """One check and its verdict."""

    check: str
    verdict: Verdict
    seen: str  # what was observed, in one line
    advice: str = ""  # how to fix it, if the rule is not kept
    last_lines: tuple[str, ...] = ()  # the last lines that the agent printed


def judge_match(report: SeatReport, clock: Clock, limits: Limits, what: str) -> Iterator[Finding]:
    """Yield what a match shows about an agent: its start, its actions and its timing."""
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


def packages(missing: Sequence[str]) -> Finding:
    """Judge a submission's requirements that this machine's Python does not fulfil."""
    if not missing:
        seen = f"this machine has what {REQUIREMENTS} names; its sandbox installs nothing"
        return Finding("packages", Verdict.KEPT, seen)
    names = ", ".join(repr(line[:LONGEST_REQUIREMENT]) for line in missing[:SHOWN_REQUIREMENTS])
    return Finding(
        "packages",
        Verdict.BROKEN,
        f"{REQUIREMENTS} names {names}, which this machine does not have, and its sandbox installs nothing",
        "do without, or put it into the submission's own files; where the judge runs containers "
        "(--sandbox oci), `wildscav build` installs it",
    )


def start_up(seconds: float, clock: Clock) -> Finding:
    """Judge how long an agent took to get ready."""
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
    """Judge whether an agent's actions are valid."""
    total, invalid = report.steps_played, report.invalid_actions
    if not invalid:
        note = f", {report.ignored_fields:,} fields ignored" if report.ignored_fields else ""
        return Finding("actions", Verdict.KEPT, f"{total:,} valid actions{note}")
    return Finding(
        "actions",
        # An agent without a single valid action plays like an empty seat, so it is no submission.
        Verdict.BROKEN if invalid == total else Verdict.DOUBTFUL,
        f"{invalid:,} of {total:,} actions were invalid and played as no action",
        f"send a walk_speed of 0 to {MAX_WALK_SPEED:g} m/s and angles that are finite numbers",
    )


def timing(report: SeatReport, clock: Clock) -> Finding:
    """Judge how long an agent took to answer."""
    time, budget = report.think_time, clock.step_budget
    seen = (
        f"the median answer took {time.p50 * 1e3:.0f} ms, p99 was {time.p99 * 1e3:.0f} ms and "
        f"the longest {time.max * 1e3:.0f} ms; a step allows {budget * 1e3:.0f} ms; "
        f"{report.time_bank:.1f} s of {clock.time_bank:.1f} s left in the bank"
    )
    if time.p50 > SLOW * budget or report.time_bank < clock.time_bank / 2:
        return Finding(
            "timing",
            Verdict.DOUBTFUL,
            seen,
            "on a slower machine it would be late, and a late step is played with no action: "
            "compute less per step, or watch observation.time_bank and answer faster when little is left",
        )
    return Finding("timing", Verdict.KEPT, seen)


def process_exit(ending: Ending | None) -> Finding:
    """Judge how an agent's process ended once its match was over; it had to be stopped if that is None."""
    check, advice = "end", "end the process with exit code 0 once MatchOver has arrived"
    if ending is None:
        seen = f"its process still ran {EXIT_TIME:g} s after the match, and was stopped"
        return Finding(check, Verdict.DOUBTFUL, seen, f"{advice}; join or stop threads and child processes")
    if ending.exit_code == 0:
        return Finding(check, Verdict.KEPT, "its process ended by itself after the match")
    return Finding(check, Verdict.DOUBTFUL, str(ending), advice, ending.last_lines)


def lateness(report: SeatReport, limits: Limits, clock: Clock) -> Finding:
    """Judge how an agent copes with steps that are played without its answer."""
    check = "late answers"
    if report.status in ("finished", "timed_out"):
        return Finding(
            check, Verdict.KEPT, f"it continued after {report.late_steps} steps without its answer"
        )
    return Finding(
        check,
        Verdict.BROKEN,
        f"{report.status.value}: {report.detail}",
        "after a late answer the next observation skips steps: answer it with its own step number, and "
        f"do not rely on any particular step. {advice_on(report.status.value, clock, limits)}",
        report.last_lines,
    )


def cancelled_match(ending: Ending | None, waited: float) -> Finding:
    """Judge how an agent copes when its stream ends in the middle of a match."""
    if ending is not None:
        seen = "its process ended by itself after this check had cancelled the match"
        return Finding("cancelled match", Verdict.KEPT, seen)
    return Finding(
        "cancelled match",
        Verdict.DOUBTFUL,
        f"its process still ran {waited:g} s after the server had ended the stream",
        "end the process when the stream ends with an error status; do not retry forever",
    )


def output(size: int, limits: Limits) -> Finding:
    """Judge how much an agent prints in a match."""
    seen = f"{size:,} of {limits.output:,} bytes printed"
    if size < limits.output:
        return Finding("output", Verdict.KEPT, seen)
    return Finding(
        "output", Verdict.DOUBTFUL, seen, "everything beyond that is discarded: print less in each step"
    )


def advice_on(status: str, clock: Clock, limits: Limits) -> str:
    """Return what an author can do about the outcome of a seat."""
    return {
        "timed_out": (
            f"each answer has {clock.step_budget * 1e3:.0f} ms, and the match has a bank of "
            f"{clock.time_bank:g} s beyond that: compute less per step, and watch observation.time_bank"
        ),
        "crashed": (
            "its process must run until the match is over; the agent's folder is read-only, only /tmp is "
            "writable, there is no network, and no package but those of its sandbox"
        ),
        "out_of_memory": (
            f"it may use {limits.memory / 2**20:.0f} MiB, including what it writes to /tmp: load smaller "
            "models, and do not keep every observation"
        ),
        "protocol_error": (
            "answer every Observation with one Action that has its step number, and send nothing else; "
            "the SDK does exactly that"
        ),
        "over_budget": "its model's budget for a match is spent: ask less often, and for shorter answers",
        "disqualified": "it exceeded a limit of its sandbox: use less of what the line above names",
        "never_joined": (
            f"within {clock.join_timeout:g} s it must connect to WILDSCAV_ADDRESS, send a Join with "
            "WILDSCAV_TOKEN, and have finished reset(): import less, load smaller models"
        ),
    }[status]
