"""The tables of results in terminals of several widths, and the lines below them: nothing is lost"""

import io
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest
from rich.console import Console
from rich.table import Table
from tests.evaluator.results_by_hand import RESULTS, evaluation, results_of, timing_of_a_seat

from wildscav.terminal.console import PlainConsole
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.check.findings import Finding, Verdict
from wildscav_evaluator.cli.result_tables import (
    LIMITS,
    RATING_LEGEND,
    evaluation_waits_note,
    invalid_actions_note,
    legend,
    sandbox_and_limits,
    timing_table,
    track_table,
)
from wildscav_evaluator.cli.sessions import check as checking
from wildscav_evaluator.cli.sessions import doctor
from wildscav_evaluator.cli.sessions import play as play_session
from wildscav_evaluator.cli.sessions import verify_records as verify
from wildscav_evaluator.cli.sessions.compare import comparison_table
from wildscav_evaluator.cli.sessions.evaluate import changes_table, verdict
from wildscav_evaluator.cli.sessions.leaderboard import evaluations_table
from wildscav_evaluator.matches.play import MatchAssignment, PlayedMatch
from wildscav_evaluator.output.results import (
    KeptLimits,
    Results,
    SeatTiming,
)
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.ratings.standings import rate
from wildscav_evaluator.sandbox import Promise
from wildscav_evaluator.scores.compare import Change, compare
from wildscav_evaluator.scores.leaderboard import standings
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.tournaments.tournament_file import Tournament
from wildscav_inspect import map as map_command
from wildscav_server.hosting.manifest import Manifest
from wildscav_server.hosting.reports import SeatReport, SeatStatus

COMPARISON = compare(RESULTS, "my-agent", "homing").comparisons[0]
LONGEST = "an-agent-whose-name-is-as-long-as-can-be"  # 40 characters, without a space to break it at
WITH_LONGEST = RESULTS.model_copy(
    update={"evaluations": (evaluation(LONGEST), evaluation("homing", values=(3.0, 4.0)))}
)
LONG = compare(WITH_LONGEST, LONGEST, "homing").comparisons[0]


def of_check(_: Path) -> Table:
    manifest = Manifest(name="my-agent", version="1", entry_point="agent:Agent", tracks=("navigation",))
    return checking._table(
        Submission(Path("/a"), manifest, ""), [Finding("cancelled match", Verdict.KEPT, "what was seen")]
    )


def of_play(_: Path) -> Table:
    manifest = Manifest(name=LONGEST, version="1", entry_point="agent:Agent", tracks=("royale",))
    spec = MatchSpec(
        track="royale",
        map=MapSpec(config=MapConfig(size=40, houses=0, water=0.0, vegetation=0.0), seed=1),
        seed=1,
        seats=("submission", "fighter"),
        time_limit=1.0,
    )
    seating = MatchAssignment(spec, (Submission(Path("/a"), manifest, ""),), (Path("/log"),))
    report = SeatReport(seat=0, status=SeatStatus.PROTOCOL_ERROR)
    return play_session._table(seating, PlayedMatch(Match(spec), {0: report}))


TABLES: dict[str, Callable[[Path], Table]] = {
    "evaluate": lambda _: track_table(RESULTS, "royale"),
    "evaluate, long names": lambda _: track_table(WITH_LONGEST, "royale"),
    "time": lambda _: timing_table(results_of("my-agent")),
    "time, long names": lambda _: timing_table(results_of(LONGEST)),
    "since": lambda _: changes_table([Change(folder="0001-a", version="1.0.0", comparison=COMPARISON)]),
    "since, long names": lambda _: changes_table([Change(folder="0001-a", version="1.0.0", comparison=LONG)]),
    "compare": lambda _: comparison_table(COMPARISON),
    "compare, long names": lambda _: comparison_table(LONG),
    "play": of_play,
    "map info": lambda _: map_command._table(
        "map 101", {"configuration": "houses=12, " * 9, "digest": "0123456789abcdef" * 4}
    ),
    "leaderboard": lambda _: evaluations_table(*standings([RESULTS])),
    "verify": lambda _: verify._table(
        [verify.Finding(Path("a/a-record-of-some-length.wsr"), True, "5 steps")]
    ),
    "doctor": lambda _: doctor._promises_table(
        "oci",
        (Promise("no network", True, "found none"), Promise("memory", False, "a long text", "install it")),
    ),
    "check": of_check,
}


@pytest.mark.parametrize("width", [60, 80, 120])
@pytest.mark.parametrize("name", TABLES)
def test_every_heading_and_cell_is_shown(name: str, width: int, tmp_path: Path) -> None:
    table = TABLES[name](tmp_path)
    console = PlainConsole(file=io.StringIO(), width=width, color_system=None)
    console.print(table)
    assert isinstance(console.file, io.StringIO)
    shown = console.file.getvalue()
    assert all(len(line) <= width for line in shown.splitlines())
    assert "…" not in shown
    for column in table.columns:
        for text in (column.header, *column.cells):
            for word in str(text).split():
                assert is_shown(word, shown), (name, word)


def is_shown(word: str, shown: str) -> bool:
    """Whether a word stands there, perhaps broken into pieces of at least four characters and the last."""
    if word in shown:
        return True
    cut = next((cut for cut in range(len(word) - 1, 3, -1) if word[:cut] in shown), 0)
    return cut > 0 and is_shown(word[cut:], shown)


@pytest.mark.parametrize("track", TRACKS)
def test_standings_of_a_hundred_matches_are_side_by_side_in_80_columns(track: str) -> None:
    ones = tuple(evaluation(name, track, (100.0, 150.0) * 50) for name in ("hunter", "learned-navigator"))
    console = PlainConsole(file=io.StringIO(), width=80, color_system=None)

    console.print(evaluations_table(*standings([RESULTS.model_copy(update={"evaluations": ones})])))

    assert isinstance(console.file, io.StringIO)
    assert console.file.getvalue().count("submission") == 1  # the heading, which blocks of lines repeat


def test_the_table_since_last_time_says_which_way_is_better() -> None:
    for track, arrow in (("navigation", "↓"), ("royale", "↑")):
        ones = (evaluation("now", track, (1.0, 2.0)), evaluation("then", track, (2.0, 3.0)))
        comparison = compare(RESULTS.model_copy(update={"evaluations": ones}), "now", "then").comparisons[0]
        table = changes_table([Change(folder="0001-a", version="1.0.0", comparison=comparison)])
        assert list(table.columns[0].cells) == [f"{track} {arrow}"]


@pytest.mark.parametrize(
    ("now", "then", "says"),
    [
        ((1.0,) * 7, (1.0,) * 7, "no change"),
        ((1.0, 2.0, 3.0, 4.0, 5.0, 6.0), (2.0, 3.0, 4.5, 5.0, 6.0, 7.5), "better"),
        ((2.0, 3.0, 4.5, 5.0, 6.0, 7.5), (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), "worse"),
        ((1.0, 2.0, 3.0, 4.0, 5.0, 6.0), (2.0, 1.0, 4.0, 3.0, 6.0, 5.0), "within the noise"),
        ((1.0, 2.0), (2.0, 3.0), "too few: 2 of 6 matches"),
    ],
)
def test_a_change_is_told_from_noise(now: tuple[float, ...], then: tuple[float, ...], says: str) -> None:
    ones = (evaluation("now", "navigation", now), evaluation("then", "navigation", then))
    results: Results = RESULTS.model_copy(update={"evaluations": ones})
    assert str(verdict(compare(results, "now", "then").comparisons[0])) == says


def played(*pairs: tuple[str, str]) -> Tournament:
    """Return a tournament in which the first of each pair beat the second."""
    matches = [RatedMatch(game=game, teams=((a,), (b,)), places=(1, 2)) for game, (a, b) in enumerate(pairs)]
    return cast(Tournament, SimpleNamespace(ratings=rate(matches)))


def test_entrants_that_never_met_are_not_compared() -> None:
    text = legend(played(("ada", "bob"), ("cy", "dee")))
    assert text.startswith(RATING_LEGEND)
    assert "2 groups that never met each other" in text


@pytest.mark.parametrize("last", [("cy", "ada"), ("cy", "bob")])
def test_entrants_that_met_through_others_need_no_explanation(last: tuple[str, str]) -> None:
    assert legend(played(("ada", "bob"), last)) == RATING_LEGEND


def seat(**changes: float) -> SeatTiming:
    usual = {"steps": 100, "late_steps": 0, "time_used": 2.0, "time_bank": 30.0}
    latencies = {"latency_p50": 0.002, "latency_p99": 0.004, "latency_max": 0.03}
    return timing_of_a_seat(**usual | latencies | changes)


@pytest.mark.parametrize(
    ("seats", "row"),
    [
        (  # the worst of all matches stands beside their median
            [
                seat(),
                seat(
                    latency_p50=0.004,
                    latency_p99=0.09,
                    latency_max=1.5,
                    time_used=4.0,
                    time_bank=28.6,
                    start_up=3.0,
                ),
            ],
            "3.0 ms 90 ms 1.5 s 3.0 s 0 28.6 s 3.0 s",
        ),
        (  # nothing is cut
            [
                seat(
                    latency_p50=0.5,
                    latency_p99=0.999,
                    latency_max=30.1,
                    time_used=999.9,
                    late_steps=100,
                    start_up=29.9,
                )
            ],
            "500 ms 999 ms 30.1 s 999.9 s 100.0% 30.0 s 29.9 s",
        ),
        # late steps are a share of those that were asked for
        ([seat(late_steps=10), seat()], "2.0 ms 4.0 ms 30 ms 2.0 s 5.0% 30.0 s 500 ms"),
        ([], "- - - - - - -"),  # one that never played
    ],
)
def test_the_times_of_a_submission_in_a_terminal_of_80_columns(seats: list[SeatTiming], row: str) -> None:
    results = results_of("homing")
    (timing,) = results.timings.matches
    matches = tuple(timing.model_copy(update={"seats": (one,)}) for one in seats)
    timings = results.timings.model_copy(update={"matches": matches})
    console = Console(file=io.StringIO(), width=80)

    console.print(timing_table(results.model_copy(update={"timings": timings})))

    assert isinstance(console.file, io.StringIO)
    *_, shown = (line for line in console.file.getvalue().splitlines() if "navigation" in line)
    assert " ".join(shown.split()) == f"navigation homing {row}"


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
    assert LIMITS.keys() == KeptLimits.model_fields.keys()


@pytest.mark.parametrize(
    ("actions", "invalid", "says"),
    [
        (1000, 1000, "me: 1,000 of 1,000 actions were invalid and played as no action"),
        (300, 1, "me: 1 of 300 actions was invalid"),
        (1, 1, "me: 1 of 1 action was invalid"),
    ],
)
def test_invalid_actions_are_told(actions: int, invalid: int, says: str) -> None:
    assert str(invalid_actions_note("me", actions=actions, invalid=invalid)).startswith(says)
    assert invalid_actions_note("me", actions=actions, invalid=0) is None


def test_what_waits_for_a_processor_did_not_cost_is_told() -> None:
    results = results_of("ann")
    seats = tuple(
        timing_of_a_seat().model_copy(update={"seat": seat, "credited": seconds})
        for seat, seconds in ((0, 1.25), (1, None), (2, 3.0))
    )
    timing = results.timings.matches[0].model_copy(update={"seats": seats})

    line = evaluation_waits_note(results.evaluations[0], [timing])

    assert evaluation_waits_note(results.evaluations[0], results.timings.matches) is None

    assert str(line).startswith("ann on navigation: the machine was so busy")
    assert str(line).endswith("its time banks did not pay 4.2 s of that, at most 3.0 s in a match")
