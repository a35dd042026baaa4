"""Short matches on small bare maps, which tests play with real agents: in suites, as jobs, and one by one."""

import asyncio
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.sandbox.available import missing

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job
from wildscav_evaluator.matches.play import MatchAssignment, PlayedMatch, play_match
from wildscav_evaluator.output.layout import LOGS, RECORDS, REPLAYS
from wildscav_evaluator.sandbox import SANDBOXES, Sandbox
from wildscav_evaluator.submissions.submission import Submission

SMALL = MapSpec(config=MapConfig(size=40, houses=0), seed=3)
NAVIGATION = MatchSpec(track="navigation", map=SMALL, time_limit=2.0)


def tiny_suite(folder: Path, maps: int = 5, seconds: float = 3.0) -> Path:
    """Write the file of a suite of short matches of navigation, and return it."""
    path = folder / "tiny.toml"
    path.write_text(
        'name = "tiny"\nmap = { size = 40, houses = 0 }\n'
        f"[tracks.navigation]\nmaps = {maps}\nmatch = {{ time_limit = {seconds} }}\n"
    )
    return path


def seated(
    *submissions: Submission,
    folder: Path,
    seconds: float = 1.0,
    track: str = "gathering",
    robots: tuple[str, ...] = (),
    **others: Any,
) -> MatchAssignment:
    """Seat submissions, and robots behind them, in a match of ten steps a second; each has a log."""
    seats = ("submission",) * len(submissions) + robots
    spec = MatchSpec(track=track, map=SMALL, seats=seats, time_limit=seconds)
    logs = tuple(folder / f"{seat}.log" for seat in range(len(submissions)))
    return MatchAssignment(spec, submissions, logs, **others)


def play(seating: MatchAssignment, sandbox: str | Sandbox = "process", **options: Any) -> PlayedMatch:
    """Play a match; skipped where there is no such sandbox."""
    if isinstance(sandbox, str):
        need(sandbox)
        sandbox = SANDBOXES[sandbox]
    return asyncio.run(play_match(seating, sandbox=sandbox, **options))


def need(sandbox: str) -> None:
    """Skip the test where a sandbox does not work."""
    if sandbox != "process" and (why := missing(sandbox)):
        pytest.skip(f"{sandbox} does not work here: {why}")


def job_of(
    submission: Submission, out: Path, index: int = 0, spec: MatchSpec = NAVIGATION, **others: Any
) -> Job:
    """Return the job of a match into an output folder, which is made, as an evaluation makes it."""
    for name in (RECORDS, REPLAYS, LOGS):
        (out / name).mkdir(parents=True, exist_ok=True)
    return Job.of_one(submission, spec.track, index, spec, out, **{"replay": False} | others)
