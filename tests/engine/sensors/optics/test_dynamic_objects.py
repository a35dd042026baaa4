"""What moves in a match is seen as it is: who lives, which boxes lie there, and which way each looks."""

import copy
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from tests.builders import act, box, make_match, place

from wildscav_engine.compilation.tables.array_tables import addresses_of
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import Kind
from wildscav_engine.rendering.dynamic_objects import DynamicObjects, ObjectSets
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.rendering.tracing.solids import NO_OWNER, gather_solids
from wildscav_engine.sensors.optics.dynamic_objects import (
    BODY,
    CRATE,
    as_dynamic_objects,
    dynamic_objects_of,
    objects_of_matches,
    placed_objects,
)
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS
from wildscav_engine.specs.match_spec import MatchSpec

TORSO, VISOR = 2, 4


def put_box(match: Match, slot: int, position: tuple[float, float, float], appears: int = 0) -> None:
    supplies = match.state.supplies
    supplies.position[0, slot], supplies.quantity[0, slot] = position, 5
    supplies.appears[0, slot], supplies.serial[0, slot] = appears, 40 + slot


def battle(seats: int = 3) -> Match:
    """A match without boxes, everybody five metres from the next."""
    match = make_match(seats=seats)
    match.state.supplies.quantity[:] = 0
    match.state.agents.invincible_left[:] = 0
    for seat in range(seats):
        place(match, seat, (5.0 * seat, 0.0, 2.0))
    return match


def instances(things: DynamicObjects, kind: Kind) -> set[int]:
    return set(things.instance[things.kind == kind].tolist())


@pytest.mark.parametrize("yaw", [0.0, 37.0, 90.0, -135.0, 180.0])
def test_an_agents_body_is_within_the_cylinder_that_is_hit(yaw: float) -> None:
    match = battle(1)
    place(match, 0, (3.0, 1.5, -2.0), yaw)
    corners = dynamic_objects_of(match).corners
    aside = np.hypot(corners[:, 0] - 3.0, corners[:, 2] + 2.0)
    assert aside.max() <= BODY_RADIUS
    assert corners[:, 1].min() == 1.5
    assert corners[:, 1].max() == pytest.approx(1.5 + BODY_HEIGHT, abs=1e-12)


def test_the_faces_of_a_part_meet_in_its_corners() -> None:
    match = battle(2)
    place(match, 1, (5.0, 0.0, 2.0), 73.0)
    put_box(match, 0, (1.0, 2.0, 3.0))
    things = dynamic_objects_of(match)
    assert len(things.kind) == 2 * len(BODY) + len(CRATE)
    for part in range(len(things.kind)):
        planes = things.faces[things.face_start[part] : things.face_start[part + 1]]
        corners = things.corners[things.corner_start[part] : things.corner_start[part + 1]]
        expected, _ = polyhedron(planes)
        assert np.sort(expected, axis=0) == pytest.approx(np.sort(corners, axis=0), abs=1e-9)
        assert np.linalg.norm(planes[:, :3], axis=1) == pytest.approx(1.0)
        assert (things.low[part] == corners.min(axis=0)).all()
        assert (things.high[part] == corners.max(axis=0)).all()


@pytest.mark.parametrize(
    ("yaw", "ahead"), [(0.0, (0, 1)), (90.0, (1, 0)), (180.0, (0, -1)), (-90.0, (-1, 0))]
)
def test_the_visor_is_on_the_side_that_an_agent_looks_to(yaw: float, ahead: tuple[int, int]) -> None:
    match = battle(1)
    place(match, 0, (0.0, 0.0, 0.0), yaw)
    things = dynamic_objects_of(match)
    middle = (things.low[VISOR] + things.high[VISOR]) / 2
    assert middle[[0, 2]] @ np.array(ahead) > 0.1


def test_the_dead_and_the_absent_are_not_seen_and_all_others_own_their_bodies() -> None:
    match = battle(4)
    match.state.agents.health[0, 1], match.state.agents.present[0, 2] = 0, False
    put_box(match, 0, (1.0, 0.0, 3.0))
    things = dynamic_objects_of(match)
    assert things.owner.tolist() == [0] * len(BODY) + [3] * len(BODY) + [NO_OWNER] * len(CRATE)
    assert instances(things, Kind.AGENT) == {0, 3}
    match.state.agents.health[:], match.state.supplies.quantity[:] = 0, 0
    assert len(dynamic_objects_of(match).kind) == 0


def test_a_box_is_there_from_its_frame_on_until_it_is_picked_up() -> None:
    match = battle(1)
    place(match, 0, (0.0, 0.0, 0.0))
    put_box(match, 0, (0.5, 0.0, 0.5))
    put_box(match, 1, (9.0, 0.0, 9.0), appears=match.frame + 1)
    assert instances(dynamic_objects_of(match), Kind.SUPPLY_BOX) == {40}
    act(match, seat_0={"pick_up": 1})
    assert match.state.supplies.quantity[0, 0] == 0
    assert instances(dynamic_objects_of(match), Kind.SUPPLY_BOX) == {41}


def test_a_box_stands_where_it_lies_and_is_about_60_cm_wide() -> None:
    match = battle(1)
    put_box(match, 0, (4.0, 1.0, -7.0))
    things = dynamic_objects_of(match)
    corners = things.corners[things.corner_start[len(BODY)] :]
    assert (corners.max(axis=0) + corners.min(axis=0))[[0, 2]] / 2 == pytest.approx([4.0, -7.0])
    assert corners[:, 1].max() == pytest.approx(1.58)
    assert corners[:, 1].min() == pytest.approx(0.9)
    assert 0.2 < np.hypot(*(corners[:, [0, 2]] - [4.0, -7.0]).T).min() < 0.5


def test_teams_have_colours_that_are_far_apart() -> None:
    match = battle(9)
    match.state.agents.team[0, 8] = 3
    torsos = dynamic_objects_of(match).color[TORSO :: len(BODY)]
    assert torsos[3] == pytest.approx(of_seat(3))
    assert (torsos[3] == torsos[8]).all()
    apart = np.abs(torsos[:8, None] - torsos[:8]).sum(axis=-1)
    assert apart[np.triu_indices(8, 1)].min() > 60


def test_who_cannot_be_hurt_is_pale() -> None:
    match = battle(2)
    before = dynamic_objects_of(match).color
    match.state.agents.invincible_left[0, 1] = 3
    after = dynamic_objects_of(match).color
    body = slice(len(BODY), None)
    assert (after[: len(BODY)] == before[: len(BODY)]).all()
    assert after[body] == pytest.approx((before[body] + 255.0) / 2)


def test_solids_of_any_making_take_the_colour_of_their_owner() -> None:
    solids = gather_solids([box((0, 0, 0), (1, 1, 1), Kind.AGENT), box((3, 0, 0), (4, 1, 1))], [2, NO_OWNER])
    things = as_dynamic_objects(solids)
    assert things.color[0] == pytest.approx(of_seat(2))
    assert things.instance.tolist() == [2, 1]
    assert as_dynamic_objects(things) is things
    assert len(as_dynamic_objects(gather_solids([])).color) == 0


def test_what_is_placed_by_hand_looks_as_it_does_in_a_match() -> None:
    match = battle(2)
    place(match, 0, (1.0, 0.5, 2.0), yaw=30.0)
    place(match, 1, (-4.0, 0.0, 3.0), yaw=-90.0)
    boxes = [(1.0, 2.0, 3.0), (5.0, 0.0, -6.0)]
    for slot, position in enumerate(boxes):
        put_box(match, slot, position)
        match.state.supplies.serial[0, slot] = slot
    of_match = dynamic_objects_of(match)
    placed = placed_objects([((1.0, 0.5, 2.0), 30.0), ((-4.0, 0.0, 3.0), -90.0)], boxes)
    for one, other in zip(of_match.sets.arrays, placed.sets.arrays, strict=True):
        assert np.array_equal(one, other)
    assert len(placed_objects([], []).kind) == 0


@pytest.mark.parametrize("part", ["agents", "supplies", "matches"])
def test_things_are_made_anew_only_when_what_they_show_has_changed(part: str) -> None:
    shown = {"present", "health", "team", "position", "yaw", "invincible_left"}  # of agents
    shown |= {"quantity", "appears", "serial", "frame"}  # of boxes, and of the match
    match = battle()
    put_box(match, 0, (1.0, 0.0, 1.0))
    arrays = getattr(match.state, part)
    for name, array in zip(arrays._fields, arrays, strict=True):
        before = dynamic_objects_of(match)
        array.reshape(-1)[-1:] = array.reshape(-1)[-1:] == 0  # an array may have no items
        changed = dynamic_objects_of(match) is not before
        assert changed == (name in shown and array.size > 0), name


def test_a_copy_of_a_match_shows_what_moves_in_itself() -> None:
    match = battle(2)
    before = dynamic_objects_of(match)
    for other in (copy.deepcopy(match.state), pickle.loads(pickle.dumps(match.state))):  # noqa: S301
        other.agents.health[0, 1] = 0
        addresses = [array.__array_interface__["data"][0] for array in other.agents]
        assert other.tables[0].addresses[:, 0].tolist() == addresses
        assert other.tables[0].arrays is other.agents
    assert dynamic_objects_of(match) is before
    fork = match.fork()
    fork.state.agents.health[0, 1] = 0
    assert len(dynamic_objects_of(fork).kind) < len(before.kind)


def test_matches_of_a_batch_have_the_things_that_each_has_alone() -> None:
    specs = [MatchSpec(track="battle", seats=("submission",) * seats, seed=seats) for seats in (2, 1, 4)]
    batch = Batch(specs, [make_match().game_map] * 3)
    batch.state.agents.health[0, 1] = 0
    batch.state.agents.invincible_left[2, 3] = 5
    batch.state.supplies.appears[1] = 10_000

    sets = objects_of_matches(batch.state)

    assert len(sets.start) == 4
    for row in range(3):
        things = dynamic_objects_of(MatchInBatch(batch, row))
        some = slice(sets.start[row], sets.start[row + 1])
        assert len(things.kind) == sets.start[row + 1] - sets.start[row] > 0
        for name in ("kind", "owner", "low", "high"):
            assert getattr(sets.arrays, name)[some].tobytes() == getattr(things, name).tobytes()
        assert sets.arrays.color[some].tobytes() == things.color.tobytes()
        assert sets.arrays.obbs[some].tobytes() == things.sets.arrays.obbs.tobytes()
        faces = sets.arrays.face_start[sets.start[[row, row + 1]]]
        assert sets.arrays.faces[slice(*faces)].tobytes() == things.faces.tobytes()


def parts_told(sets: ObjectSets) -> list[bytes]:
    """Return the parts of all matches without the room behind them."""
    count = sets.start[-1]
    return [sets.start.tobytes()] + [
        array[: len(array) - len(sets.arrays.kind) + count].tobytes()
        for name, array in sets.arrays._asdict().items()
        if name not in ("faces", "corners")
    ]


def test_things_that_take_the_place_of_others_are_the_same() -> None:
    specs = [MatchSpec(track="battle", seats=("submission",) * 2, seed=seed) for seed in range(3)]
    batch = Batch(specs, [make_match().game_map] * 3)
    room = None
    for health, quantity in ((100, 0), (100, 3), (0, 3), (100, 3), (0, 0)):
        batch.state.agents.health[1], batch.state.supplies.quantity[2] = health, quantity
        new, room = objects_of_matches(batch.state), objects_of_matches(batch.state, room)
        assert parts_told(room) == parts_told(new)
        faces, corners = room.start[-1] * 6, room.start[-1] * 8
        assert room.arrays.faces[:faces].tobytes() == new.arrays.faces.tobytes()
        assert room.arrays.corners[:corners].tobytes() == new.arrays.corners.tobytes()
        assert (room.most, room.most_faces) == (new.most, new.most_faces)
    assert objects_of_matches(batch.state, room).arrays is room.arrays


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda things: pickle.loads(pickle.dumps(things))])  # noqa: S301
def test_a_copy_of_things_is_the_same_with_a_table_of_its_own(
    copied: Callable[[DynamicObjects], DynamicObjects],
) -> None:
    things = dynamic_objects_of(battle(2))
    other = copied(things)
    for one, same in zip((*things, things.color), (*other, other.color), strict=True):
        assert one.tobytes() == same.tobytes()
    assert (things.instance == other.instance).all()
    for sets in (things.sets, other.sets, copy.deepcopy(things.sets)):
        assert (sets.addresses == addresses_of(sets.arrays)).all()
    assert (other.sets.addresses[:, 0] != things.sets.addresses[:, 0]).all()


def test_things_in_arrays_that_kernels_cannot_read_are_refused() -> None:
    things = dynamic_objects_of(battle(2))
    with pytest.raises(TypeError, match=r"ObjectArrays\.color is float32 .*, must be float64 with 2"):
        _ = DynamicObjects(things.solids, things.instance, things.color.astype(np.float32)).sets
    with pytest.raises(ValueError, match="color is not contiguous"):
        _ = DynamicObjects(things.solids, things.instance, things.color[::-1]).sets
