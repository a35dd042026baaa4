"""Agents of strangers run in a sandbox, or not at all, unless the organizer says otherwise."""

from pathlib import Path

import pytest
from tests.leaderboard.seasons_made import make_season

from wildscav.errors import UserError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.conductor.work import VARIABLE, chosen_sandbox
from wildscav_leaderboard.seasons.folder import Season
from wildscav_server.monitoring.logs import open_log


@pytest.fixture
def season(tmp_path: Path) -> Season:
    """A season whose settings name no sandbox."""
    season = make_season(tmp_path / "season")
    execution = season.settings.execution.model_copy(update={"sandbox": None})
    return Season(season.folder, season.settings.model_copy(update={"execution": execution}))


@pytest.fixture(autouse=True)
def _bare_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without the programs that sandboxes need."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv(VARIABLE, raising=False)


def test_nothing_is_played_where_no_sandbox_works(season: Season) -> None:
    with pytest.raises(UserError, match=r"no sandbox works here .+ sandbox = 'process' in the settings"):
        chosen_sandbox(season, LocalExecutor(1), open_log(None))


def test_the_settings_may_ask_for_none(tmp_path: Path) -> None:
    season = make_season(tmp_path / "trusting")
    assert season.settings.execution.sandbox == "process"
    assert chosen_sandbox(season, LocalExecutor(1), open_log(None)) == "process"


def test_the_environment_may_name_one_for_all_seasons(
    season: Season, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "bubblewrap")
    with pytest.raises(UserError, match="the sandbox bubblewrap cannot be kept here"):
        chosen_sandbox(season, LocalExecutor(1), open_log(None))


def test_the_warning_names_what_an_organizer_can_set(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    chosen_sandbox(make_season(tmp_path / "trusting"), LocalExecutor(1), open_log("text"))
    said = "".join(capsys.readouterr())
    assert "set sandbox = 'bubblewrap' or 'oci' under [execution]" in said
    assert "--sandbox" not in said
