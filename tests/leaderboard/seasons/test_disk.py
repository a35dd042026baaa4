"""What a season does while its disk is nearly full."""

from pathlib import Path

import httpx
import pytest
from tests.leaderboard.seasons_made import NOON, make_season, team_with_member
from tests.leaderboard.spectating.served import served

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.access.uploads import check_upload_wanted
from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.seasons import disk
from wildscav_leaderboard.seasons.refusals import UnavailableError

FULL = r"the disk of the season has [\d.]+ GiB left: nothing new is begun"


def test_nothing_is_taken_in_or_begun_while_the_disk_is_nearly_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    season = make_season(tmp_path / "season")
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        _, captain = team_with_member(session, "foxes")
    monkeypatch.setattr(disk, "FLOOR", 1 << 60)

    with pytest.raises(UnavailableError, match=FULL):
        check_upload_wanted(database, season, captain, NOON)
    with pytest.raises(UnavailableError, match=FULL), LocalExecutor(1) as executor:
        Conductor(season, database).round(executor)
    app = create_app(season, database)
    with served(app) as address:
        answer = httpx.get(f"{address}/ready")
        assert answer.status_code == 503
        assert "the disk of the season" in answer.json()["reason"]
        assert httpx.get(f"{address}/").status_code == 200  # what is there is shown
    app.state.renders.close()
    database.close()
