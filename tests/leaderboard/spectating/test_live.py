"""Running matches as spectators are told of them, compared with their records."""

import json
from collections.abc import Callable
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import pytest
from tests.leaderboard.spectating.moments import moments_of

from wildscav_engine.record import Record, read_record
from wildscav_evaluator.matches.snapshots import Snapshot
from wildscav_leaderboard.spectating.live import COLUMNS, LiveMatches
from wildscav_stage.scene.document import Box, Event, News, Trails, values_of
from wildscav_stage.scene.trails import trails_of

Records = Callable[[str], Path]
TRACKS = ("navigation", "gathering", "battle", "capture", "royale")


class Told(NamedTuple):
    """What the file of a match tells."""

    beginning: Trails
    news: list[News]

    def column(self, seat: int, name: str) -> list[int]:
        return [each for news in self.news for each in values_of(getattr(news.samples.seats[seat], name))]

    @property
    def frames(self) -> list[int]:
        return [frame for news in self.news for frame in values_of(news.samples.frames)]

    @property
    def events(self) -> list[Event]:
        return [event for news in self.news for event in news.events]

    @property
    def boxes(self) -> list[Box]:
        boxes: list[Box] = []
        for news in self.news:
            boxes += news.boxes
            for place, frame in news.taken:
                boxes[place] = boxes[place].model_copy(update={"taken": frame})
        return boxes


def told_in(file: Path) -> Told:
    beginning, *news = file.read_bytes().splitlines()
    return Told(Trails.model_validate_json(beginning), [News.model_validate_json(line) for line in news])


def play(live: LiveMatches, record: Record, steps: int = 10_000, together: int = 7) -> Told:
    """Play a match up to a step, with a heartbeat for every few steps."""
    waiting: list[Snapshot] = []
    for step, snapshot in enumerate(moments_of(record)):
        waiting.append(snapshot)
        if step % together == 0 or step == min(steps, record.steps):
            live.add("m1", record.spec, record.names, waiting)
            waiting = []
        if step == steps:
            break
    return told_in(live.path("m1"))


@pytest.fixture(params=TRACKS)
def record(request: pytest.FixtureRequest, record_of_track: Records) -> Record:
    return read_record(record_of_track(request.param))


@pytest.fixture
def battle(record_of_track: Records) -> Record:
    return read_record(record_of_track("battle"))


def test_spectators_are_told_what_the_record_will_tell(tmp_path: Path, record: Record) -> None:
    shown, told = play(LiveMatches(tmp_path), record), trails_of(record)

    beginning = shown.beginning
    assert not beginning.over
    assert (beginning.target, beginning.zone) == (told.target, told.zone)
    assert [(seat.name, seat.team, seat.result) for seat in beginning.seats] == [
        (seat.name, seat.team, None) for seat in told.seats
    ]
    frames = values_of(told.samples.frames)
    both = sorted(set(shown.frames) & set(frames))
    assert len(both) >= len(frames) - 1  # but for the last moment
    for number, kept in enumerate(told.samples.seats):
        for name in COLUMNS:
            here = dict(zip(shown.frames, shown.column(number, name), strict=True))
            there = dict(zip(frames, values_of(getattr(kept, name)), strict=True))
            assert [here[frame] for frame in both] == [there[frame] for frame in both], name


def test_shots_boxes_and_events_are_those_of_the_record(tmp_path: Path, record: Record) -> None:
    shown, told = play(LiveMatches(tmp_path), record), trails_of(record)

    assert shown.events == told.events
    assert shown.boxes == told.boxes
    for name in ("frames", "seats", "x", "z", "height"):
        shots = [each for news in shown.news for each in values_of(getattr(news.shots, name))]
        assert shots == values_of(getattr(told.shots, name)), name


def test_what_happens_between_two_moments_is_told_with_the_later_one(tmp_path: Path, battle: Record) -> None:
    every_tenth = []
    for _, moments in groupby(enumerate(moments_of(battle)), lambda each: (each[0] + 9) // 10):
        moment, *before = [snapshot for _, snapshot in moments][::-1]
        parts = ("happened", "shots", "appeared", "taken")
        noted = {name: sum((getattr(each, name) for each in [*before[::-1], moment]), ()) for name in parts}
        every_tenth.append(moment._replace(**noted))
    live = LiveMatches(tmp_path)
    live.add("m1", battle.spec, battle.names, every_tenth)

    assert told_in(live.path("m1")).events == trails_of(battle).events


def test_a_match_that_is_played_again_begins_anew(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle, steps=60)

    again = play(live, battle, steps=20)

    assert (again.frames[0], again.frames[-1]) == (0, 100)


def test_a_match_whose_beginning_was_missed_is_not_shown(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    live.add("m1", battle.spec, battle.names, list(moments_of(battle))[5:9])

    assert not live.path("m1").exists()


def test_a_line_holds_half_a_second_in_a_kilobyte(tmp_path: Path, battle: Record) -> None:
    live = LiveMatches(tmp_path)
    play(live, battle, together=5)

    lines = live.path("m1").read_bytes().splitlines()[1:]
    assert json.loads(lines[1])["samples"]["frames"] == [5, 5, 5, 5, 5]
    assert sum(map(len, lines)) / len(lines) / len(battle.names) < 400  # bytes a seat


def test_a_match_that_has_ended_is_gone_and_so_is_what_a_killed_conductor_left(
    tmp_path: Path, battle: Record
) -> None:
    for remove in (lambda live: live.end("m1"), LiveMatches.clear):
        live = LiveMatches(tmp_path)
        play(live, battle, steps=20)
        remove(live)
        assert list(tmp_path.iterdir()) == []
