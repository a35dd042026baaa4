"""Teammates know of each other, and of nobody else."""

import numpy as np
from tests.builders import flat_world, make_match, place

from wildscav_engine.sensors import SafeZone, Teammates
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase


def test_teammates_are_listed_nearest_first_in_sight_or_not() -> None:
    match = make_match("battle", seats=5, teams=(0, 0, 1, 0, 1))
    for seat, spot in enumerate(((0, 0, 0), (0, 0, -9), (1, 0, 0), (3, 0, 4), (0, 0, 2))):
        place(match, seat, spot)
    agents = match.state.agents
    agents.velocity[0, 3], agents.yaw[0, 3] = (1, 2, 3), 50
    agents.supplies[0, 3], agents.invincible_left[0, 3], agents.health[0, 1] = 12, 5, 0
    near, far, *unused = Teammates().read(match, [0])[0]
    assert near.tolist() == [1, 3, 3, 0, 4, 5, 1, 2, 3, 50, 100, 1, 12]
    assert far[[1, 4, 10]].tolist() == [1, -9, 0]
    assert not np.any(unused)


def test_only_as_many_as_asked_for_are_listed() -> None:
    match = make_match("gathering", seats=4, teams=(0, 0, 0, 0))
    assert Teammates(limit=2).read(match, [0, 3])[:, :, 0].tolist() == [[1, 1], [1, 1]]


def test_who_is_alone_has_no_teammates() -> None:
    assert not Teammates().read(make_match("battle", seats=3), [0, 1, 2]).any()


def test_the_zone_tells_how_far_inside_one_is_and_what_comes() -> None:
    phases = (
        ZonePhase(wait=2, shrink=4, share=0.5, damage=3),
        ZonePhase(wait=1, shrink=1, share=0, damage=9),
    )
    match = make_match("royale", world=flat_world(size=80), zone=ZoneConfig(phases=phases))
    place(match, 0, (10, 0, 0))
    row = match.state.matches.zone[0, 0]
    radius = 40 * np.sqrt(2)
    reading = SafeZone().read(match, [0])[0]
    wanted = [1, radius - 10, -10, 0, radius, row[5] - 10, row[6], radius / 2, 2, 6, 3]
    np.testing.assert_allclose(reading, wanted, rtol=1e-6)
    match.state.matches.frame[0] = 6 * 50
    reading = SafeZone().read(match, [0])[0]
    np.testing.assert_allclose(reading[[4, 7, 8, 9, 10]], [radius / 2, 0, 1, 2, 9], rtol=1e-6)
    match.state.matches.frame[0] = 60 * 50
    reading = SafeZone().read(match, [0])[0]
    assert reading[[4, 7, 8, 9]].tolist() == [0, 0, 0, 0]
    assert reading[[2, 3]].tolist() == reading[[5, 6]].tolist()


def test_other_tracks_have_no_zone() -> None:
    assert not SafeZone().read(make_match("battle"), [0]).any()
