"""The notebook that reads a season's public data runs as it stands."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.hosting.clients import serving_filled
from tests.recorded_matches import record_of_track

__all__ = ["record_of_track"]

NOTEBOOK = Path(__file__).parents[3] / "docs" / "examples" / "season_data.ipynb"


def test_it_reads_boards_and_matches_without_an_account_and_verifies_a_record(
    new_filled_season: Callable[..., FilledSeason],
    record_of_track: Callable[[str], Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    filled = new_filled_season()
    filled.give_records(record_of_track("battle").read_bytes())
    names: dict[str, Any] = {}
    with serving_filled(filled) as site:
        monkeypatch.setenv("WILDSCAV_SEASON", str(site.client.base_url).rstrip("/"))
        for cell in json.loads(NOTEBOOK.read_text("utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                exec(compile("".join(cell["source"]), "notebook", "exec"), names)  # noqa: S102 (our own)
        names["season"].close()

    said = capsys.readouterr().out
    assert set(names["boards"]) <= {track["name"] for track in names["about"]["tracks"]}
    assert sum(names["played"].values()) > 0
    assert (tmp_path / "matches.png").stat().st_size > 0
    assert "holds=True" in said
