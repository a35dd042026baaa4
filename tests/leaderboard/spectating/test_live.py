"""Running matches as pages see them, compared with their records."""

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from wildscav_engine.record import Record, read_record, resimulate
from wildscav_evaluator.matches.snapshots import Snapshot, snapshot_of
from wildscav_leaderboard.spectating.live import COLUMNS, LiveMatches
from wildscav_stage.scene.document import values_of
from wildscav_stage.scene.trails import trails_of

Records = Callable[[str], Path]
TRACKS = ("navigation", "gathering", "battle", "capture", "royale")


def snapshots_of(record: Record) -> Iterator[Snapshot]:
    """Every moment of a match, one after the other, as it is played."""
    for match in resimulate(record):
        yield snapshot_of(match)


def play(live: LiveMatches, record: Record, steps: int = 10_000) -> None:
    """Play a match up to a step, with a heartbeat for every seven steps."""
    waiting: list[Snapshot] = []
    for step, snapshot in enumerate(snapshots_of(record)):
        waiting.append(snapshot)
        if step % 7 == 0 or step == min(steps, record.steps):
            live.add("m1", record.spec, record.names, waiting)
            waiting = []
        if step == steps:
            return


@pytest.fixture(params=TRACKS)
def record(request: pytest.FixtureRequest, record_of_track: Records) -> Record:
    return read_record(record_of_track(request.param))


@pytest.fixture
def battle(record_of_track: Records) -> Record:
    return read_record(record_of_track("battle"))


def test_a_page_sees_what_the_record_will_tell(tmp_path: Path, record: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, record)

    shown, told = live.trails("m1"), trails_of(record)

    assert shown is not None
    assert not shown.over
    assert (shown.target, shown.zone) == (told.target, told.zone)
    assert [(seat.name, seat.team, seat.result) for seat in shown.seats] == [
        (seat.name, seat.team, None) for seat in told.seats
    ]
    frames = [values_of(each.samples.frames) for each in (shown, told)]
    both = sorted(set(frames[0]) & set(frames[1]))
    assert len(both) >= len(frames[1]) - 1  # but for the last moment
    for seen, kept in zip(shown.samples.seats, told.samples.seats, strict=True):
        for name in COLUMNS:
            here = dict(zip(frames[0], values_of(getattr(seen, name)), strict=True))
            there = dict(zip(frames[1], values_of(getattr(kept, name)), strict=True))
            assert [here[frame] for frame in both] == [there[frame] for frame in both], name


def test_deaths_pick_ups_and_respawns_are_told(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle)

    shown = live.trails("m1")

    assert shown is not None
    seen, told = (Counter(event.kind for event in each.events) for each in (shown, trails_of(battle)))
    assert seen["death"] == told["death"] > 0
    assert seen["respawn"] == told["respawn"]
    assert 0 < seen["pick_up"] <= told["pick_up"]  # two in one moment look like one


def test_documents_after_each_other_are_the_whole(tmp_path: Path, battle: Record) -> None:
    live, reader = LiveMatches(tmp_path), LiveMatches(tmp_path)
    frames: list[int] = []
    heights: list[int] = []
    cursor = ""

    for place, snapshot in enumerate(snapshots_of(battle)):
        live.add("m1", battle.spec, battle.names, [snapshot])
        if place % 40 == 0:
            shown = reader.trails("m1", cursor)
            assert shown is not None
            assert shown.first is (place == 0)
            frames += values_of(shown.samples.frames)
            heights += values_of(shown.samples.seats[1].height)
            cursor = shown.cursor
    rest, whole = reader.trails("m1", cursor), reader.trails("m1")

    assert rest is not None
    assert whole is not None
    assert frames + values_of(rest.samples.frames) == values_of(whole.samples.frames)
    assert heights + values_of(rest.samples.seats[1].height) == values_of(whole.samples.seats[1].height)
    assert set(whole.samples.frames[1:]) == {5}


def test_a_match_that_is_played_again_begins_anew(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle, steps=60)
    before = live.trails("m1")
    assert before is not None

    play(live, battle, steps=20)
    again = live.trails("m1", before.cursor)

    assert again is not None
    assert again.first
    assert again.samples.frames[0] == 0
    assert again.frames == 100


@pytest.mark.parametrize("cursor", ["", "nonsense", "0-999999", "ffff-12", "1-" + "9" * 30])
def test_a_cursor_of_something_else_gives_the_whole(tmp_path: Path, battle: Record, cursor: str) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle, steps=20)

    shown = live.trails("m1", cursor)

    assert shown is not None
    assert shown.first
    assert shown.frames == 100


def test_half_a_line_is_left_for_the_next_document(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle, steps=20)
    file = next(tmp_path.glob("*.live"))
    whole = file.read_bytes()
    file.write_bytes(whole[:-30])

    first = live.trails("m1")
    assert first is not None
    file.write_bytes(whole)
    rest = live.trails("m1", first.cursor)

    assert rest is not None
    assert (first.frames, rest.samples.frames) == (95, [100])


def test_a_match_that_has_ended_is_gone(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle, steps=20)

    live.end("m1")

    assert live.trails("m1") is None
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_conductor_left_can_be_removed(tmp_path: Path, battle: Record) -> None:
    play(LiveMatches(tmp_path), battle, steps=20)

    LiveMatches(tmp_path).clear()

    assert list(tmp_path.iterdir()) == []
