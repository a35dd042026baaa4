"""How agents used their time, and what they ran in, as an organizer reads it."""

import io

import pytest
from rich.console import Console
from tests.evaluator.results_by_hand import timing_of_a_seat

from wildscav_evaluator.cli.result_tables.timing import sandbox_and_limits, timing_table
from wildscav_evaluator.output.results import (
    CURRENT_VERSIONS,
    Evaluation,
    KeptLimits,
    MatchTiming,
    Results,
    SeatTiming,
    Timings,
    metric_infos,
)


def seat(**changes: float) -> SeatTiming:
    usual = {"steps": 100, "late_steps": 0, "time_used": 2.0, "time_bank": 30.0}
    latencies = {"latency_p50": 0.002, "latency_p99": 0.004, "latency_max": 0.03}
    return timing_of_a_seat(**usual | latencies | changes)


def results(*seats: SeatTiming) -> Results:
    """The results of a submission with a match for each of these seats."""
    homing = Evaluation(
        submission="homing",
        version="1",
        digest="",
        track="navigation",
        metrics=metric_infos("navigation"),
        matches=(),
        summary={},
    )
    matches = tuple(
        MatchTiming(
            submission="homing", track="navigation", index=index, started=0, wall=1, steps=100, seats=(one,)
        )
        for index, one in enumerate(seats)
    )
    timings = Timings(started="", wall=0.0, jobs=1, matches=matches)
    return Results(
        versions=CURRENT_VERSIONS,
        suite="quick",
        seed=0,
        sandbox="process",
        evaluations=(homing,),
        timings=timings,
    )


def cells(*seats: SeatTiming) -> list[str]:
    """The row of the table in a terminal of 80 columns, cell by cell."""
    console = Console(file=io.StringIO(), width=80)
    console.print(timing_table(results(*seats)))
    assert isinstance(console.file, io.StringIO)
    *_, row = (line for line in console.file.getvalue().splitlines() if "navigation" in line)
    return row.split()


def test_the_worst_of_all_matches_is_shown_beside_their_median() -> None:
    worse = seat(
        latency_p50=0.004, latency_p99=0.09, latency_max=1.5, time_used=4.0, time_bank=28.6, start_up=3.0
    )

    row = cells(seat(), worse)

    assert " ".join(row) == "navigation homing 3.0 ms 90 ms 1.5 s 3.0 s 0 28.6 s 3.0 s"


def test_nothing_is_cut_in_a_narrow_terminal() -> None:
    worst = seat(latency_p50=0.5, latency_p99=0.999, latency_max=30.1, time_used=999.9, late_steps=100)

    row = cells(worst.model_copy(update={"start_up": 29.9}))

    assert " ".join(row) == "navigation homing 500 ms 999 ms 30.1 s 999.9 s 100.0% 30.0 s 29.9 s"


def test_late_steps_are_a_share_of_those_that_were_asked_for() -> None:
    assert "5.0%" in cells(seat(late_steps=10), seat())


def test_a_submission_that_never_played_has_no_times() -> None:
    assert cells()[2:] == ["-"] * 7


@pytest.mark.parametrize(
    ("limits", "lines"),
    [
        ({}, ["oci"]),
        ({"battle": KeptLimits(wall_clock=60)}, ["oci; each agent: matches of 60 s at most"]),
        (
            {
                "navigation": KeptLimits(cpus=1, memory=2**31, output=10**6),
                "gathering": KeptLimits(cpus=1, memory=2**31, output=10**6),
                "battle": KeptLimits(cpus=0.5, memory=600 * 2**20, processes=64, tmp_size=5001),
            },
            [
                "oci; each agent on navigation, gathering: 1 core, 2 GiB of memory, 1 MB of output",
                "oci; each agent on battle: 0.5 cores, 600 MiB of memory, 64 processes, 5,001 bytes in /tmp",
            ],
        ),
    ],
)
def test_conditions_are_told_once_for_all_tracks_that_share_them(
    limits: dict[str, KeptLimits], lines: list[str]
) -> None:
    assert list(sandbox_and_limits("oci", limits)) == lines
