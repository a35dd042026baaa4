"""A season that was played and opened, exported once, and copies of it to tamper with."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.leaderboard.auditing.tampering import Published
from tests.leaderboard.played_seasons import end_season

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.auditing.audit import Audit
from wildscav_leaderboard.auditing.record_checks import Wanted
from wildscav_leaderboard.auditing.report import Report
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.publishing.export import export
from wildscav_leaderboard.seasons.folder import Season

Run = Callable[..., Report]


@pytest.fixture(scope="module")
def before_the_end(played: tuple[Season, Database], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of its folder while it still goes on."""
    return Path(shutil.copytree(played[0].folder, tmp_path_factory.mktemp("copy") / "season"))


@pytest.fixture(scope="module")
def after_opening(
    played: tuple[Season, Database],
    exported: Path,
    before_the_end: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """What is published of it afterwards."""
    season, database = played
    end_season(database, season)
    folder = tmp_path_factory.mktemp("after") / "export"
    export(season, database, folder)
    return folder


@pytest.fixture
def opened(after_opening: Path, tmp_path: Path) -> Published:
    """A copy of what is published after the secrets were opened, to tamper with."""
    return Published(Path(shutil.copytree(after_opening, tmp_path / "opened")))


@pytest.fixture
def hidden(exported: Path, tmp_path: Path) -> Published:
    """A copy of what is published before the secrets are opened, to tamper with."""
    return Published(Path(shutil.copytree(exported, tmp_path / "hidden")))


@pytest.fixture
def audit(tmp_path: Path) -> Run:
    """Audit a folder or an address in this process."""

    def run(place: object, **wanted: object) -> Report:
        return Audit(Wanted(**wanted), LocalExecutor(1), tmp_path / "cache").run(str(place))  # type: ignore[arg-type]

    return run
