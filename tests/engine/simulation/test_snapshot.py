"""States as bytes: whoever goes on from one plays as if nothing had happened."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world, map_from

from wildscav_engine.record import record_of, verify_record
from wildscav_engine.simulation import snapshot
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.setup.match_setup import MatchSetupError
from wildscav_engine.simulation.snapshot import StateError
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.binary_format import pack, unpack
from wildscav_engine.tracks import TRACKS

MEADOW = map_from(flat_world())
YARD = map_from(flat_world(solids=[box((3, 0, -9), (4, 3, 9))]))
SEATS = ("submission", "fighter", "gatherer")
STEPS = 20


def match_of(track: str, seed: int = 1, game_map: object = MEADOW, **fields: object) -> Match:
    return Match(MatchSpec(track=track, seed=seed, seats=SEATS, **fields), game_map)


def actions(step: int) -> NDArray[np.float32]:
    return np.random.default_rng(step).uniform(0, 9, (len(SEATS), FIELDS)).astype(np.float32)


def play(match: Match, first: int, last: int) -> Match:
    for step in range(first, last):
        match.step(actions(step))
    return match


def bytes_of(match: Match) -> list[bytes]:
    return [array.tobytes() for part in (*match.state, match.seen) for array in part]


@pytest.mark.parametrize("track", TRACKS)
def test_a_match_goes_on_from_its_bytes_and_as_a_fork(track: str) -> None:
    original = play(match_of(track), 0, STEPS)
    data, fork = original.get_state(), original.fork()
    restored = match_of(track, seed=99)
    restored.set_state(data)

    play(original, STEPS, 2 * STEPS)

    for other in (fork, restored):
        assert other.frame < original.frame
        play(other, STEPS, 2 * STEPS)
        assert bytes_of(other) == bytes_of(original)
        assert other.digests == original.digests
        assert other.result() == original.result()
        assert other.get_state() == original.get_state()

    digests = original.digests
    original.set_state(data)  # in the middle of a match
    assert play(original, STEPS, 2 * STEPS).digests == digests


def test_a_fork_that_plays_otherwise_leaves_the_original_alone() -> None:
    original, same = (play(match_of("battle"), 0, STEPS) for _ in range(2))
    fork = original.fork()
    for _ in range(STEPS):
        fork.step()
    assert bytes_of(play(original, STEPS, 2 * STEPS)) == bytes_of(play(same, STEPS, 2 * STEPS))
    assert fork.digest != original.digest


def test_robots_of_a_state_play_where_there_were_none() -> None:
    original = play(match_of("battle"), 0, STEPS)
    alone = MatchSpec(track="battle", map=original.spec.map, seats=("submission",) * len(SEATS))
    restored = Match(alone, MEADOW)
    restored.set_state(original.get_state())
    assert play(restored, STEPS, 2 * STEPS).digest == play(original, STEPS, 2 * STEPS).digest


def test_a_row_of_a_batch_goes_on_in_another_batch_with_other_sizes() -> None:
    def spec(seed: int) -> MatchSpec:
        return MatchSpec(track="royale", seed=seed, seats=SEATS[: 2 + seed % 2])

    first = Batch([spec(seed) for seed in range(3)], [MEADOW, MEADOW, YARD])
    second = Batch([spec(seed) for seed in (7, 8)], [MEADOW, YARD])
    for step in range(STEPS):
        first.step(np.array([actions(step)] * 3))
        second.step(np.array([actions(step)] * 2))
    second.set_state(0, first.get_state(2))
    assert second.specs[0] == first.specs[2]
    for step in range(STEPS):
        first.step(np.array([actions(step)] * 3))
        second.step(np.array([actions(step)] * 2))
    assert second.get_state(0) == first.get_state(2)


def test_a_restored_match_has_a_record_that_verifies() -> None:
    small = MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.1), seed=3)
    match = play(Match(MatchSpec(track="battle", map=small, seats=SEATS, time_limit=5)), 0, 10)
    data = match.get_state()
    other = Match(match.spec.model_copy(update={"seed": 5}))
    other.set_state(data)
    other.play_out()
    assert verify_record(record_of(other, SEATS)).holds


def test_what_is_no_state_of_this_engine_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    match = match_of("battle")
    data = match.get_state()
    before = bytes_of(match)
    refused = [
        (b"nothing", "the state is not a state of a match"),
        (data[:-1], "the state is truncated or edited: its checksum does not match"),
        (match._batch.get_state(0), "the state is of a row of a batch, which does not keep what was played"),
    ]
    for content, fault in refused:
        with pytest.raises(StateError) as error:
            match.set_state(content)
        assert str(error.value) == fault
    with pytest.raises(MatchSetupError, match="same track"):
        match.set_state(match_of("gathering").get_state())
    monkeypatch.setitem(snapshot.VERSIONS, "simulation_version", 999)
    with pytest.raises(StateError, match=r"of simulation version \d+; this engine has 999"):
        match.set_state(data)
    assert bytes_of(match) == before


@pytest.mark.parametrize(
    ("field", "value", "fault"),
    [
        ("counts", [3, 1000, 0, 0, 1], "of another build of this engine: its arrays have other sizes"),
        ("counts", [2, 60, 0, 0, 1], "of 2 seats, but its spec has 3"),
        ("counts", 3, "payload does not fit its header"),
        ("size", 10**9, "payload does not fit its header"),
        ("steps", 10**6, "payload does not fit its header"),
    ],
)
def test_a_state_whose_arrays_do_not_fit_leaves_the_match_as_it_was(
    field: str, value: object, fault: str
) -> None:
    match = play(match_of("battle"), 0, STEPS)
    header, payload = unpack(snapshot.LAYOUT, match.get_state())
    before = bytes_of(match)
    with pytest.raises(StateError, match=fault):
        match.set_state(pack(snapshot.LAYOUT, header | {field: value}, payload))
    assert bytes_of(match) == before
    match.step()


def test_a_state_on_a_map_that_is_not_made_here_is_refused() -> None:
    # Both maps were made by hand, so nobody can make them from their spec.
    with pytest.raises(StateError, match="its spec generates"):
        match_of("battle").set_state(match_of("battle", game_map=YARD).get_state())
