"""What the page of evaluations says is true: its suites, files and metrics exist, and its commands run."""

import re
import tomllib
from pathlib import Path

import pytest
from tests.end_to_end.pages import blocks, run_line
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav_evaluator.matches.play import MAX_ATTEMPTS
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.output.layout import (
    EXCHANGES,
    IDENTITY_FILE,
    LEDGER_FILE,
    LOGS,
    OPENED_FILE,
    RECORDS,
    REPLAYS,
    RESULTS_FILE,
    SUITE_FILE,
)
from wildscav_evaluator.scores.compare import FEWEST_PAIRS
from wildscav_evaluator.scores.score import RESAMPLES
from wildscav_evaluator.suites.reading import READING
from wildscav_evaluator.suites.suite import SUITES
from wildscav_evaluator.suites.suite_file import read_suite

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "evaluation.md"
TEXT = PAGE.read_text("utf-8")


FIGURES = (ROOT / "benchmarks" / "results" / "baselines.md").read_text("utf-8")


def rows(head: str, text: str = TEXT) -> list[list[str]]:
    """The rows of the table with that head, cell by cell."""
    table = text[text.index(head) :].split("\n\n", maxsplit=1)[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table]


def test_the_suites_have_the_maps_matches_and_limits_told() -> None:
    for name, *told in rows("| suite | navigation |"):
        suite = SUITES[name.strip("`")]
        for track, cell in zip(("navigation", "gathering", "capture", "battle", "royale"), told, strict=True):
            if track not in suite.tracks:
                assert not cell
                continue
            course = suite.tracks[track]
            (seconds,) = {spec.time_limit for spec in suite.matches(track, 0)}
            assert cell == f"{course.maps} × {course.episodes}, {seconds:g} s"


def test_the_scale_of_the_suite_across_tracks_is_told() -> None:
    for track, zero, one, agent in rows("| track | 0: `random` | 1 |", FIGURES):
        reference = READING.references[track]
        assert [float(cell.split()[0]) for cell in (zero, one)] == [reference.zero, reference.one]
        assert agent == f"`{reference.agent}`"


def test_the_own_suite_of_the_page_is_one(tmp_path: Path) -> None:
    toml, _ = blocks(PAGE, "toml")
    (tmp_path / "spring.toml").write_text(toml)
    suite = read_suite(tmp_path / "spring.toml")

    assert len(suite.matches("navigation", 0)) == 6
    assert len(suite.matches("gathering", 0)) == 2


def test_the_model_of_the_page_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    _, toml = blocks(PAGE, "toml")
    settings = ModelSettings.model_validate(tomllib.loads(toml))
    monkeypatch.setenv("MODEL_KEY", "secret")

    assert (settings.host, settings.key()) == ("localhost:8000", "secret")


def test_every_file_of_the_output_folder_is_told() -> None:
    cells = [row[0] for row in rows("| in the output folder |")]
    told = {name.rstrip("/") for cell in cells for name in re.findall(r"`([\w./]+)`", cell)}

    folders = {RECORDS, REPLAYS, LOGS, EXCHANGES}
    assert told == folders | {RESULTS_FILE, IDENTITY_FILE, LEDGER_FILE, SUITE_FILE, OPENED_FILE}


def test_the_numbers_of_the_text_are_those_of_the_code() -> None:
    assert f"Fewer than {FEWEST_PAIRS} matches are too few" in TEXT
    assert f"with {RESAMPLES:,} resamples" in TEXT
    assert {3: "three"}[MAX_ATTEMPTS] + " times over" in " ".join(TEXT.split())


# Of Ray, the tests of its executor tell.
ELSEWHERE = ("pip install", "ray start", "wildscav doctor --executor ray")


@pytest.mark.slow
def test_the_commands_of_the_page_run_in_their_order(tmp_path: Path) -> None:
    """With matches of two seconds on two maps, of which only the first command makes replays."""
    toml, _ = blocks(PAGE, "toml")
    toml = re.sub(r"time_limit = \d+", "time_limit = 2", toml)
    (tmp_path / "spring.toml").write_text(
        toml.replace("maps = 3", "maps = 1").replace("maps = [103, 104]", "maps = [103]")
    )
    (tmp_path / "submissions").symlink_to(ROOT / "submissions")
    run_line("wildscav init my-agent", tmp_path)
    lines = [line for block in blocks(PAGE, "console") for line in block.splitlines()]
    here = [line for line in lines if not line.startswith(ELSEWHERE) and "--executor ray" not in line]
    evaluations = [line for line in here if line.startswith("wildscav evaluate")]
    shorter = dict.fromkeys(evaluations, ("--replays", "none")) | {lines[0]: ("--suite", "spring.toml")}
    with WarmWorkers() as workers, playing_with(workers):
        said = {line: run_line(line, tmp_path, *shorter.get(line, ())) for line in here}

    assert len(here) >= 9
    assert "all agree with out/spring/results.json" in said["wildscav verify out/spring"]
    (checked,) = (text for line, text in said.items() if "--commitment" in line)
    assert "is the one committed to" in checked
    assert "all agree" in run_line("wildscav verify out/hidden", tmp_path)
