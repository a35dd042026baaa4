"""The safe zone in a replay: where the edge was, and where it will be."""

from pathlib import Path

import numpy as np
from rerun.chunk import RrdReader
from tests.builders import act, flat_world, make_match
from tests.engine.view.conftest import robots_play

from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase
from wildscav_engine.view import write_replay
from wildscav_engine.view.entities.zone import CORNERS, LIFT, ring, static_zone
from wildscav_engine.view.events import events_of
from wildscav_engine.view.recording.history import collect_history


def test_the_history_has_the_zone_of_every_step_and_the_circle_that_it_draws_in_to() -> None:
    first = ZonePhase(wait=0.5, shrink=1, share=0.5, damage=0)
    phases = (first, ZonePhase(wait=0, shrink=1, share=0, damage=0))
    match = make_match("royale", world=flat_world(), seats=2, zone=ZoneConfig(phases=phases), time_limit=3)

    def play():
        yield match
        while not match.over:
            act(match)
            yield match

    zone = collect_history(play(), 30, None)[1].zone
    assert zone is not None
    full = 20 * np.sqrt(2)
    np.testing.assert_allclose(zone[[0, 5, 10, 15, 20, 25], 2], full * np.array([1, 1, 0.75, 0.5, 0.25, 0]))
    np.testing.assert_allclose(zone[[0, 14, 15, 25], 5], [full / 2, full / 2, 0, 0])


def test_a_ring_lies_on_the_ground_and_on_the_map() -> None:
    line = ring(flat_world(size=40, slope=0.1), np.array([5.0, 0.0, 30.0]))
    assert line.shape == (CORNERS + 1, 3)
    assert np.abs(line[:, [0, 2]]).max() <= 20
    np.testing.assert_allclose(line[:, 1], line[:, 0] * 0.1 + LIFT)


def test_the_rings_are_thin_lines_to_who_stands_at_them_too() -> None:
    phase = ZonePhase(wait=1, shrink=1, share=0.5, damage=0)
    match = make_match("royale", world=flat_world(), seats=2, zone=ZoneConfig(phases=(phase,)))
    looks = dict(static_zone(collect_history([match], 0, None)[1]))
    for path in ("zone/edge", "zone/next"):
        assert looks[path].radii.as_arrow_array()[0].as_py() < 0  # below 0: pixels in the picture, not metres


def test_a_royale_shows_its_zone_and_other_tracks_have_none(tmp_path: Path) -> None:
    for track, shown in (("royale", True), ("gathering", False)):
        write_replay(robots_play(track), tmp_path / f"{track}.rrd", images=False)
        entities = set(RrdReader(tmp_path / f"{track}.rrd").store().schema().entity_paths())
        assert ({"/zone/edge", "/zone/next", "/zone/outside"} <= entities) == shown


def test_who_does_not_come_back_is_out() -> None:
    match = make_match("royale", seats=3, zone=ZoneConfig())
    match.state.agents.damage[0, 1] = 1000

    def play():
        yield match
        act(match)
        yield match

    events = events_of(collect_history(play(), 1, None)[1], ("ann", "bob", "eve"))
    assert ("OUT", "bob is out") in [(event.kind, event.text) for event in events]
