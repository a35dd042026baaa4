"""What the help of commands says of --json is true: the fields that their documents have."""

import json
import re
from dataclasses import fields
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.end_to_end.pages import ROOT, json_documents, names
from tests.evaluator.results_by_hand import MODEL, RESULTS

from wildscav_engine.extensions import Addition, Origin
from wildscav_evaluator.check.findings import Verdict
from wildscav_evaluator.executors import Examined
from wildscav_evaluator.output.results import write_results
from wildscav_evaluator.sandbox import Promise
from wildscav_evaluator.scores.compare import compare
from wildscav_leaderboard.auditing.report import Finding
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.initial_files import make_season_folder


def document(*arguments: object) -> dict[str, object]:
    """What a command prints with --json, and nothing else on stdout."""
    done = run_command(*arguments, "--json")
    assert done.stdout, done.stderr
    return json.loads(done.stdout)  # type: ignore[no-any-return]


def test_the_documents_have_the_fields_told(tmp_path: Path) -> None:
    (tmp_path / "none.wsr").touch()
    assert names(document("verify", tmp_path / "none.wsr")) == json_documents()["verify of records"]

    played = RESULTS.model_copy(update={"model": MODEL})
    standings = document("leaderboard", write_results(played, tmp_path), "--track", "roy")
    assert json_documents()["leaderboard"] <= names(standings)
    (one,) = standings["standings"]  # type: ignore[misc]
    assert [row["submission"] for row in one["rows"]] == ["homing", "my-agent"]

    assert names(document("map", "info", 101)) == json_documents()["map info"]
    assert names(document("map", "make", "--level", "easy", "--count", 1)) == json_documents()["map make"]
    make_season_folder(tmp_path / "season", "spring", None, days=10)
    checked = document("season", "check", tmp_path / "season")
    assert checked.keys() == json_documents()["season check"]
    assert "there is no database" in str(checked["note"])
    attempts = {field.name for field in fields(Attempt)}
    assert (
        names(document("season", "status", tmp_path / "season")) | attempts
        == json_documents()["season status"]
    )
    exported = tmp_path / "exported"
    season = Season.open(tmp_path / "season")
    export(season, season.database(), exported)
    findings = {field.name for field in fields(Finding)}
    assert names(document("verify", exported)) | findings == json_documents()["verify of a season"]
    assert set(compare(RESULTS, "my-agent", "homing").as_json()) | {"folder"} == json_documents()["compare"]
    of_extensions = {*Addition._fields, *Origin._fields, "extensions"}
    of_sandboxes = {"sandboxes", "default", "promises", *(field.name for field in fields(Promise))}
    assert of_extensions | of_sandboxes == json_documents()["doctor"]
    of_nodes = {"nodes", *(field.name for field in fields(Examined))}
    assert of_nodes == json_documents()["doctor with --executor ray"]
    assert {verdict.value for verdict in Verdict} <= json_documents()["check"]


def test_each_paragraph_about_documents_is_compared_with_a_document() -> None:
    tests = [path.read_text("utf-8") for path in (ROOT / "tests").rglob("test_*.py")]
    compared = r"""json_documents\(\)\["([\w -]+)"\]|shown\("([\w -]+)"|told="([\w -]+)\""""
    found = {name for text in tests for match in re.findall(compared, text) for name in match}
    assert json_documents().keys() - found == set()


@pytest.mark.slow
def test_what_a_match_prints_has_the_fields_told(tmp_path: Path) -> None:
    played = document("play", "homing", "--time-limit=2", "--size=40", f"--logs={tmp_path}")
    assert names(played) == json_documents()["play"]
