"""What the page of tournaments says is true: its numbers, files and fields exist, and its commands run."""

import inspect
import re
from pathlib import Path

import pytest
from tests.end_to_end.pages import blocks, run_code, run_line
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav_engine.record import read_record
from wildscav_evaluator.bounds import FEWEST_ENTRANTS, MAX_ENTRANTS, MAX_MATCHES, MAX_PLAYERS
from wildscav_evaluator.cli.commands.tournament import tournament
from wildscav_evaluator.cli.options.tournament import USUAL_SEATS, USUAL_TEAM
from wildscav_evaluator.cli.result_tables import MAX_OPPONENTS
from wildscav_evaluator.output.layout import STANDINGS_PICTURE, TOURNAMENT_FILE
from wildscav_evaluator.ratings import standings
from wildscav_evaluator.ratings.bands import FEWEST_GAMES
from wildscav_evaluator.ratings.fit import RESAMPLES
from wildscav_evaluator.ratings.picture import MAX_SHOWN
from wildscav_evaluator.suites.suite import SUITES
from wildscav_evaluator.tournaments.schedule import make_schedule

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "tournaments.md"
TEXT = PAGE.read_text("utf-8")
WORDS = " ".join(TEXT.split())
ARENA = """
name = "arena"
map = { size = 40, houses = 0 }

[tracks.battle]
maps = 4
match = { time_limit = 2, supplies = { waves = [{ center = [0, 0], radius = 15 }] } }

[tracks.royale]
maps = 2
match = { time_limit = 2 }
"""
HIDDEN = """
wildscav season secret new final.secret
wildscav season key new final.key
wildscav tournament robot:fighter robot:fighter-easy robot:gatherer --track royale --suite arena.toml \
--seats 3 --rounds 6 --secret final.secret --sign final.key --out out/final
wildscav verify out/final --key "$(wildscav season key public final.key)"
wildscav season secret open final.secret out/final
wildscav verify out/final --commitment $(wildscav season secret commitment final.secret)
"""  # with the options of evaluations that the page names
LINES = [line for block in (*blocks(PAGE, "console"), HIDDEN.strip()) for line in block.splitlines()]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a suite of short matches."""
    (tmp_path / "arena.toml").write_text(ARENA)
    return tmp_path


def test_the_numbers_of_the_text_are_those_of_the_code() -> None:
    rounds = inspect.signature(tournament).parameters["rounds"].default
    assert f"A tournament has {FEWEST_ENTRANTS} to {MAX_ENTRANTS:,} entrants" in WORDS
    assert f"at most {MAX_MATCHES:,} matches, and at most {MAX_PLAYERS:,} seats" in WORDS
    assert f"`--rounds`, {rounds} by default" in WORDS
    assert f"In fewer than {FEWEST_GAMES} games no two entrants can be told apart" in WORDS
    assert f"a bootstrap with {RESAMPLES:,} resamples" in WORDS
    assert f"They are in the table (up to {MAX_OPPONENTS} entrants)" in WORDS
    assert f"in the picture (the best {MAX_SHOWN})" in WORDS
    assert f"in `tournament.json` (the best {standings.MAX_PAIRED})" in WORDS
    assert f"{USUAL_SEATS} where these have a single seat" in WORDS
    assert f"`--team-size {USUAL_TEAM}` forms teams of two seats" in WORDS
    for suite, seats in (("quick", 6), ("official", 10)):
        for track in ("battle", "royale"):
            assert len(SUITES[suite].matches(track, 0)[0].seats) == seats


def test_the_tournament_of_the_picture_has_the_matches_told() -> None:
    assert "of ten entrants" in WORDS
    assert len(make_schedule(10, seats=6, rounds=10, seed=0).games) == 100


def test_the_example_rates_matches(tmp_path: Path) -> None:
    code = (ROOT / "docs" / "examples" / "rate_matches.py").read_text("utf-8")
    assert run_code(code, tmp_path).splitlines() == [
        *("ada 1723 (1, 2)", "bob 1461 (1, 3)", "cy 1316 (2, 3)"),
        "(('ada', 'bob'), ('bob', 'cy'))",
        "1833 157",
    ]


@pytest.mark.slow
def test_the_commands_of_the_page_run_in_their_order(folder: Path) -> None:
    """The matches last two seconds, and only those of robots alone have replays."""
    short = "[tracks.{}]\nmaps = 1\nmatch = {{ time_limit = 2 }}\n"
    tracks = [short.format(track) for track in ("battle", "capture", "gathering")]
    (folder / "short.toml").write_text('name = "short"\nmap = { size = 40, houses = 0 }\n' + "".join(tracks))
    shorter = ("--suite=short.toml", "--rounds=1", "--replays=none")
    printed = {}
    with WarmWorkers() as workers, playing_with(workers):
        for line in LINES:
            more: tuple[str, ...] = ()
            if line.endswith("--out out/arena"):
                more = ("--suite=arena.toml",)
            elif line.startswith("wildscav tournament") and "--suite" not in line:
                more = shorter
            printed[line] = run_line(line, folder, *more)

    assert "all agree" in printed["wildscav verify out/arena"]
    assert any("is the one committed to" in text for line, text in printed.items() if "--commitment" in line)
    assert "all agree" in run_line("wildscav verify out/final", folder)
    assert sorted(path.name[:5] for path in (folder / "out" / "tournaments").iterdir()) == [
        "0001-",
        "0002-",
        "0003-",
    ]

    (of_robots,) = (text for line, text in printed.items() if line.endswith("--out out/arena"))
    out = folder / "out" / "arena"
    assert "battle · 4 entrants · 12 matches · suite arena@" in of_robots
    assert "time of the agents" not in of_robots
    assert (out / "replays" / "battle-000.rrd").exists(), "a match without agents has a replay, too"
    table = TEXT[TEXT.index("| file | |") :].split("\n\n")[0]
    assert set(re.findall(r"^\| `([\w.]+)`", table, re.MULTILINE)) == {TOURNAMENT_FILE, STANDINGS_PICTURE}
    assert all((out / name).exists() for name in (TOURNAMENT_FILE, STANDINGS_PICTURE))
    assert read_record(out / "records" / "battle-000.wsr").spec.track == "battle"
