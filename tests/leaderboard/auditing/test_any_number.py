"""Whichever number of a board is changed, and however little, the audit fails and names a field."""

import shutil
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.leaderboard.auditing.tampering import Published, numbers, replace_at

from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_leaderboard.auditing.audit import Audit
from wildscav_leaderboard.auditing.record_checks import Wanted

TRACKS = ("navigation", "battle")
CHANGES = st.sampled_from((1, -1, 0.01, -1e-6, 1e-9, 1000.0))


@pytest.fixture(scope="module")
def published(after_opening: Path, tmp_path_factory: pytest.TempPathFactory) -> Published:
    folder = tmp_path_factory.mktemp("numbers") / "season"
    return Published(Path(shutil.copytree(after_opening, folder)))


@pytest.mark.parametrize("track", TRACKS)
@settings(max_examples=20)
@given(data=st.data(), by=CHANGES)
def test_any_number_of_a_board(published: Published, track: str, data: st.DataObject, by: float) -> None:
    right = published.board(track)
    path = data.draw(st.sampled_from(list(numbers(right))))

    def put_back(board: dict[str, Any]) -> None:
        board.clear()
        board.update(right)

    published.change_board(track, lambda board: replace_at(board, path, lambda number: number + by))
    try:
        audit = Audit(Wanted(track=track, records=0), LocalExecutor(1), published.folder)
        report = audit.run(str(published))
    finally:
        published.change_board(track, put_back)
    assert not report.holds, path
    assert all(one.track == track for one in report.findings)
