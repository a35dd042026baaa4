"""What the page of the command line says of --json is true: which commands have it, and which fields."""

import json
import re
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import typer
from tests.commands import run_command
from tests.evaluator.results_by_hand import MODEL, RESULTS

from wildscav.cli import main
from wildscav_evaluator.check.findings import Verdict
from wildscav_evaluator.output.results import write_results
from wildscav_evaluator.scores.compare import compare
from wildscav_leaderboard.auditing.report import Finding
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.initial_files import make_season_folder

PAGE = Path(__file__).parents[2] / "docs" / "command-line.md"
TEXT = PAGE.read_text("utf-8")
ROWS = re.findall(r"^\| `([a-zA-Z… ]+)` \| (.+) \|$", TEXT.partition("## JSON")[2], re.MULTILINE)
TOLD = {command: set(re.findall(r"`([\w ]+)`", fields)) for command, fields in ROWS}
APART = ("metrics", "limits", "figures", "missing")  # what stands in them has names of its own


def test_the_commands_told_are_those_that_take_json() -> None:
    def taking(command: Any, path: str) -> Iterator[str]:
        for name in command.list_commands(None) if hasattr(command, "list_commands") else ():
            yield from taking(command.get_command(None, name), f"{path} {name}".strip())
        if any("--json" in parameter.opts for parameter in command.params):
            yield path

    told = {command.rstrip("ACDEFLORTU… ") for command in TOLD}
    assert set(taking(typer.main.get_command(main.app), "")) == told


def document(*arguments: object) -> dict[str, object]:
    """What a command prints with --json, and nothing else on stdout."""
    done = run_command(*arguments, "--json")
    assert done.stdout, done.stderr
    return json.loads(done.stdout)  # type: ignore[no-any-return]


def names(document: object) -> set[str]:
    """Every field of a document."""
    if isinstance(document, dict):
        inner = [names(value) for key, value in document.items() if key not in APART]
        return set(document).union(*inner)
    if isinstance(document, list):
        return set().union(*map(names, document))
    return set()


def test_the_documents_have_the_fields_told(tmp_path: Path) -> None:
    (tmp_path / "none.wsr").touch()
    assert names(document("verify", tmp_path / "none.wsr")) == TOLD["verify RECORD…"]

    played = RESULTS.model_copy(update={"model": MODEL})
    standings = document("leaderboard", write_results(played, tmp_path), "--track", "roy")
    assert TOLD["leaderboard"] <= names(standings)
    (one,) = standings["standings"]  # type: ignore[misc]
    assert [row["submission"] for row in one["rows"]] == ["homing", "my-agent"]

    assert names(document("map", "info", 101)) == TOLD["map info"]
    assert names(document("map", "make", "--level", "easy", "--count", 1)) == TOLD["map make"]
    make_season_folder(tmp_path / "season", "spring", None, days=10)
    checked = document("season", "check", tmp_path / "season")
    assert checked.keys() == TOLD["season check"]
    assert "there is no database" in str(checked["note"])
    attempts = {field.name for field in fields(Attempt)}
    assert names(document("season", "status", tmp_path / "season")) | attempts == TOLD["season status"]
    exported = tmp_path / "exported"
    season = Season.open(tmp_path / "season")
    export(season, season.database(), exported)
    findings = {field.name for field in fields(Finding)}
    assert names(document("verify", exported)) | findings == TOLD["verify URL"]
    assert set(compare(RESULTS, "my-agent", "homing").as_json()) | {"folder"} == TOLD["compare"] - {"json"}
    assert {verdict.value for verdict in Verdict} <= TOLD["check"]


@pytest.mark.slow
def test_what_a_match_prints_has_the_fields_told(tmp_path: Path) -> None:
    played = document("play", "homing", "--time-limit=2", "--size=40", f"--logs={tmp_path}")
    assert names(played) == TOLD["play"]
