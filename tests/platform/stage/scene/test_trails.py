"""The trails of real matches, compared with the matches played again."""

import gzip
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from wildscav_engine.record import Record, read_record, record_of, resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.systems.zone import zone_at
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_stage.scene.document import Circle, Trails, ZonePhase, differences, values_of
from wildscav_stage.scene.trails import trails_of

TRACKS = ("navigation", "gathering", "battle", "capture", "royale")
Records = Callable[[str], Path]


class Shown(NamedTuple):
    """A record and its trails."""

    record: Record
    trails: Trails


@pytest.fixture(scope="module")
def shown(record_of_track: Records) -> Callable[[str], Shown]:
    """What is shown of the match of a track."""

    @cache
    def of_track(track: str) -> Shown:
        record = read_record(record_of_track(track))
        return Shown(record, trails_of(record))

    return of_track


Of = Callable[[str], Shown]
on_each_track = pytest.mark.parametrize("track", TRACKS)


def circle_at(phases: list[ZonePhase], frame: int) -> tuple[float, float, float]:
    """The safe zone in cm, as a page works it out."""
    phase = next((each for each in phases if frame < each.end), phases[-1])
    part = min(1.0, max(0.0, (frame - phase.start) / (phase.end - phase.start)))

    def between(name: str, before: Circle = phase.before, after: Circle = phase.after) -> float:
        return float(getattr(before, name) + (getattr(after, name) - getattr(before, name)) * part)

    return between("x"), between("z"), between("radius")


@on_each_track
def test_every_sample_is_where_the_agents_stood(shown: Of, track: str) -> None:
    record, trails = shown(track)
    samples = {frame: place for place, frame in enumerate(values_of(trails.samples.frames))}
    courses = [
        {name: values_of(values) for name, values in seat.model_dump().items()}
        for seat in trails.samples.seats
    ]
    compared = 0

    for match in resimulate(record):
        if match.frame not in samples:
            continue
        place, agents = samples[match.frame], match.state.agents
        for seat, values in enumerate(courses):
            here = {name: column[place] for name, column in values.items()}
            there = [here["x"], here["height"], here["z"]]
            np.testing.assert_allclose(np.array(there) / 100, agents.position[0, seat], atol=0.00501)
            assert abs((here["yaw"] - agents.yaw[0, seat] + 180) % 360 - 180) < 0.501
            assert here["pitch"] == pytest.approx(agents.pitch[0, seat], abs=0.501)
            assert here["health"] == agents.health[0, seat]
            assert here["supplies"] == agents.supplies[0, seat]
        compared += 1

    assert compared == len(samples)


def test_with_many_agents_samples_are_farther_apart(shown: Of, monkeypatch: pytest.MonkeyPatch) -> None:
    record, trails = shown("battle")
    frames = values_of(trails.samples.frames)
    monkeypatch.setattr("wildscav_stage.scene.trails.MANY", 2)  # half of its seats
    assert values_of(trails_of(record).samples.frames) == sorted({*frames[::2], frames[-1]})


@pytest.mark.parametrize("values", [[], [7], [3, 3, -2, 1000]])
def test_differences_add_up_to_the_values(values: list[int]) -> None:
    assert values_of(differences(values)) == values


def test_shots_end_where_they_did(shown: Of) -> None:
    record, trails = shown("battle")
    shots, fired = trails.shots, 0
    columns = [values_of(each) for each in (shots.frames, shots.seats, shots.x, shots.height, shots.z)]
    there = {(frame, seat): place for frame, seat, *place in zip(*columns, strict=True)}

    for match in resimulate(record):
        agents = match.state.agents
        for seat in np.flatnonzero(agents.fired[0]).tolist() if match.frame else ():
            end = np.array(there[match.frame, seat]) / 100
            np.testing.assert_allclose(end, agents.shot_end[0, seat], atol=0.00501)
            fired += 1

    assert fired == len(there) > 10


@on_each_track
def test_a_document_has_whole_turns_ten_samples_a_second_and_what_the_record_says(
    shown: Of, track: str
) -> None:
    record, trails = shown(track)
    frames = np.array(values_of(trails.samples.frames))

    assert Trails.model_validate_json(gzip.decompress(trails.compressed())) == trails
    assert max(abs(turn) for seat in trails.samples.seats for turn in seat.yaw[1:]) <= 180
    assert (frames[0], frames[-1]) == (0, trails.frames)
    assert set(np.diff(frames)[:-1].tolist()) == {5}
    assert 0 < frames[-1] - frames[-2] <= 5
    for seat, told in enumerate(trails.seats):
        result = record.result.seats[seat]
        assert (told.name, told.kind) == (record.names[seat], record.spec.seats[seat])
        assert told.team == result.team
        assert told.result is not None
        assert told.result.metrics == result.metrics
        assert (told.result.kills, told.result.deaths) == (result.kills, result.deaths)
    assert (trails.over, trails.ending) == (True, record.result.ending)


def test_events_add_up_to_the_results_of_a_battle(shown: Of) -> None:
    trails = shown("battle").trails
    results = [seat.result for seat in trails.seats if seat.result]
    kinds = Counter(event.kind for event in trails.events)

    assert kinds["death"] == sum(result.deaths for result in results) > 0
    assert kinds["hit"] > 0
    assert kinds["pick_up"] > 0
    deaths = Counter(event.other for event in trails.events if event.kind == "death")
    assert [deaths[seat.seat] for seat in trails.seats] == [result.kills for result in results]
    frames = [event.frame for event in trails.events]
    assert frames == sorted(frames)


def test_who_is_out_of_a_royale_is_said_once(shown: Of) -> None:
    trails = shown("royale").trails
    out = [event.seat for event in trails.events if event.kind == "out"]

    assert sorted(out) == sorted(
        seat.seat for seat in trails.seats if values_of(trails.samples.seats[seat.seat].health)[-1] == 0
    )
    assert out


def test_the_safe_zone_of_a_page_is_that_of_the_rules(shown: Of) -> None:
    record, trails = shown("royale")
    *_, match = resimulate(record)

    for frame in range(0, trails.frames, 50):
        now = zone_at(match.state.matches, 0, frame)
        circle = circle_at(trails.zone, frame)
        np.testing.assert_allclose(np.array(circle) / 100, (now.x, now.z, now.radius), atol=0.006)
    assert any(event.kind == "zone" for event in trails.events)


@pytest.mark.parametrize(("track", "has"), [("navigation", True), ("capture", True), ("battle", False)])
def test_only_tracks_with_a_target_show_one(shown: Of, track: str, has: bool) -> None:
    assert (shown(track).trails.target is not None) is has


def test_reaching_the_target_is_an_event(shown: Of) -> None:
    trails = shown("navigation").trails

    reached = [event for event in trails.events if event.kind == "target"]
    success = [seat.result and seat.result.metrics["success"] for seat in trails.seats]
    assert len(reached) == min(1, success.count(1.0))


def test_boxes_lie_there_until_somebody_takes_them(shown: Of) -> None:
    trails = shown("gathering").trails
    taken = [box for box in trails.boxes if box.taken is not None]

    assert 0 < len(taken) < len(trails.boxes)
    assert sum(box.quantity for box in taken) == sum(
        event.amount for event in trails.events if event.kind == "pick_up"
    )


@pytest.mark.slow
def test_a_battle_of_fifteen_minutes_fits_in_a_page() -> None:
    """Its trails are as long as it is, so the first three minutes tell."""
    spec = MatchSpec(
        track="battle",
        map=MapSpec(config=MapConfig(size=200, houses=6), seed=2),
        seats=("fighter",) * 10,
        time_limit=180.0,
        seed=1,
    )
    match = Match(spec)
    match.play_out()

    part = trails_of(record_of(match, spec.seats)).compressed()

    assert 5 * len(part) < 1_500_000
