"""A season whose people and agents write texts that would take over a page, if they could."""

from collections.abc import Iterator

import pytest
from tests.leaderboard.filled_season import HOSTILE, FilledSeason, fill_season


@pytest.fixture(scope="session")
def hostile_season(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FilledSeason]:
    folder = tmp_path_factory.mktemp("hostile")
    record = folder / "match.wsr"
    record.write_bytes(b"no record that could be rendered")
    filled = fill_season(folder, words=HOSTILE, record=record)
    yield filled
    filled.database.close()
