"""The tables of results in terminals of several widths: nothing that they say is lost."""

import io
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.table import Table
from tests.evaluator.results_by_hand import RESULTS, evaluation, results_of

from wildscav.terminal.console import PlainConsole
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.check.findings import Finding, Verdict
from wildscav_evaluator.cli.result_tables.ranking import track_table
from wildscav_evaluator.cli.result_tables.timing import timing_table
from wildscav_evaluator.cli.sessions import check as checking
from wildscav_evaluator.cli.sessions import doctor
from wildscav_evaluator.cli.sessions import play as play_session
from wildscav_evaluator.cli.sessions import verify_records as verify
from wildscav_evaluator.cli.sessions.compare import comparison_table
from wildscav_evaluator.cli.sessions.evaluate import changes_table, verdict
from wildscav_evaluator.cli.sessions.leaderboard import ladder_table
from wildscav_evaluator.matches.play import PlayedMatch, Seating
from wildscav_evaluator.output.results import Results
from wildscav_evaluator.sandbox import Promise
from wildscav_evaluator.scores.changes import Change
from wildscav_evaluator.scores.compare import compare
from wildscav_evaluator.scores.leaderboard import standings
from wildscav_evaluator.submissions.submission import Manifest, Submission
from wildscav_inspect import map as map_command
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
    seating = Seating(spec, (Submission(Path("/a"), manifest, ""),), (Path("/log"),))
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
    "leaderboard": lambda _: ladder_table(*standings([RESULTS])),
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
