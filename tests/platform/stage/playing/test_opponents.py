"""Submissions at the table: processes that play beside the person."""

import asyncio
from pathlib import Path
from typing import Any

import pytest
from tests.platform.stage.playing.pages import page
from tests.platform.stage.playing.tables import small_plan, table

from wildscav_engine.record import Record, read_record, verify_record

HOMING = Path(__file__).parents[4] / "submissions" / "homing"
MANIFEST = 'name = "{name}"\nversion = "1.0"\nentry_point = "agent:Agent"\ntracks = ["navigation"]\n'

pytestmark = pytest.mark.slow


def play_against(folder: Path, records: Path) -> tuple[Record, dict[str, Any]]:
    async def play() -> dict[str, Any]:
        async with (
            table(small_plan("navigation", 3.0, (str(folder),)), records) as link,
            page(link) as person,
        ):
            assert not (await person.until("table"))["may_pause"]
            await person.send(kind="start")
            await person.send(kind="pause", paused=True)
            return await person.until("over")

    over = asyncio.run(play())
    return read_record(Path(over["record"])), over


def test_a_submission_plays_beside_the_person(tmp_path: Path) -> None:
    record, over = play_against(HOMING, tmp_path)
    assert record.names == ("person", "homing")
    assert {row["name"] for row in over["rows"]} == {"person", "homing"}
    assert record.result.seats[1].walked > record.result.seats[0].walked
    assert verify_record(record).holds


def test_a_match_goes_on_without_a_submission_that_fails(tmp_path: Path) -> None:
    folder = tmp_path / "broken"
    folder.mkdir()
    (folder / "submission.toml").write_text(MANIFEST.format(name="broken"))
    (folder / "agent.py").write_text("import does_not_exist\n")

    record, _ = play_against(folder, tmp_path)
    assert record.result.seats[1].walked == 0.0
    assert record.steps == 150  # all 3 s of it
    assert "does_not_exist" in (tmp_path / "1-broken.log").read_text()
