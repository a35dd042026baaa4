"""Jobs of an evaluation and their results, written by hand: nothing is played."""

from pathlib import Path

from tests.evaluator.results_by_hand import timing_of_a_seat

from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.results import MatchRow, MatchTiming
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.manifest import Manifest


def jobs(**counts: int) -> list[Job]:
    """So many matches of each track, all of one submission."""
    manifest = Manifest(
        name="walker", version="1", entry_point="agent:Agent", tracks=("navigation", "battle", "gathering")
    )
    walker = Submission(Path("/walker"), manifest, digest="0" * 32)
    return [
        Job.of_one(walker, track, index, MatchSpec(track=track, time_limit=60.0), Path("/out"), replay=False)
        for track, count in counts.items()
        for index in range(count)
    ]


def played(job: Job, wall: float, score: float = 1.0, *, fault: bool = False) -> JobResult:
    metrics = {"time": score, "supplies": score}
    row = MatchRow(
        index=job.index,
        status="crashed" if fault else "finished",
        fault="agent" if fault else None,
        metrics=metrics,
    )
    seat = timing_of_a_seat(steps=100, latency_p50=0.01, latency_p99=0.01)
    timing = MatchTiming(
        submission="walker",
        track=job.track,
        index=job.index,
        started=0.0,
        wall=wall,
        steps=100,
        seats=(seat,),
    )
    return JobResult(job, row, timing)
