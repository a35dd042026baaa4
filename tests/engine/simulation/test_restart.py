"""Restarting matches in the rows of a running batch: as good as new, and nobody else notices."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world, map_from

from wildscav_engine.maps.bank import MapBank
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.setup.match_setup import MatchSetupError
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

MEADOW = map_from(flat_world())
YARD = map_from(flat_world(solids=[box((3, 0, -9), (4, 3, 9))]))
SEATS = ("submission", "fighter", "gatherer")
STEPS = 25


def spec(seed: int, track: str = "battle", seats: Sequence[str] = SEATS, **fields: object) -> MatchSpec:
    return MatchSpec(track=track, seed=seed, seats=seats, **fields)


def meadows(matches: int, track: str = "battle") -> Batch:
    return Batch([spec(seed, track) for seed in range(matches)], [MEADOW] * matches)


def actions(seed: int, batch: Batch) -> NDArray[np.float32]:
    """Some actions, the same for the same seed."""
    random = np.random.default_rng(seed)
    shape = (*batch.state.agents.present.shape, FIELDS)
    return random.uniform(0, 9, shape).astype(np.float32)


def row_of(batch: Batch, row: int) -> list[bytes]:
    """All bytes of a match, padding apart."""
    agents, supplies, matches = batch.state
    seats, slots, phases = (int(count[row]) for count in (matches.seats, matches.slots, matches.phases))
    found = [array[row, :seats].tobytes() for array in (*agents, *batch.seen, matches.members_left)]
    found += [array[row, :slots].tobytes() for array in supplies]
    skipped = {"map_index", "members_left", "zone", "wave_centers", "crowd"}
    found += [getattr(matches, name)[row].tobytes() for name in matches._fields if name not in skipped]
    waves = matches.wave_centers[row, : matches.waves[row]]
    return [*found, matches.zone[row, :phases].tobytes(), waves.tobytes()]


@pytest.mark.parametrize("track", ["battle", "royale", "gathering", "navigation"])
def test_a_restarted_match_is_as_a_new_one(track: str) -> None:
    batch = meadows(3, track)
    for step in range(STEPS):
        batch.step(actions(step, batch))

    batch.restart([1], [spec(7, track)], [YARD])
    fresh = Batch([spec(7, track)], [YARD])

    assert row_of(batch, 1) == row_of(fresh, 0)
    for step in range(STEPS):
        rows = actions(step, batch)
        batch.step(rows)
        fresh.step(rows[1:2])
    assert row_of(batch, 1) == row_of(fresh, 0)


def test_the_other_rows_of_a_batch_do_not_notice() -> None:
    batch, undisturbed = meadows(3), meadows(3)
    for step in range(STEPS):
        rows = actions(step, batch)
        batch.step(rows)
        undisturbed.step(rows)
        if step % 5 == 0:
            batch.restart([1], [spec(100 + step)], [YARD if step % 2 else MEADOW])
        assert row_of(batch, 0) == row_of(undisturbed, 0)
        assert row_of(batch, 2) == row_of(undisturbed, 2)


def test_a_batch_grows_for_a_match_with_more_boxes_and_waves() -> None:
    rich = SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0), outdoor_richness=50, time=5.0),) * 3, spacing=1)
    batch = meadows(2)
    slots = batch.state.supplies.serial.shape[1]
    batch.step(actions(0, batch))
    before = row_of(batch, 0)

    batch.restart([1], [spec(3, supplies=rich)], [MEADOW])

    assert batch.state.supplies.serial.shape[1] > slots
    assert row_of(batch, 0) == before
    assert row_of(batch, 1) == row_of(Batch([spec(3, supplies=rich)], [MEADOW]), 0)


def test_a_match_with_fewer_seats_fits_and_one_with_more_does_not() -> None:
    batch = meadows(2)
    batch.restart([0], [spec(5, seats=("submission",))], [MEADOW])
    assert row_of(batch, 0) == row_of(Batch([spec(5, seats=("submission",))], [MEADOW]), 0)
    with pytest.raises(MatchSetupError, match="4 seats, but those of this batch have at most 3"):
        batch.restart([0], [spec(5, seats=("submission",) * 4)], [MEADOW])


def test_a_match_that_cannot_be_set_up_leaves_all_as_it_is() -> None:
    batch = meadows(2)
    before = [row_of(batch, row) for row in range(2)]
    outside = spec(9, start=(500.0, 0.0, 0.0))
    for rows, specs, error in (
        ([0, 1], [spec(8), outside], "outside the map"),
        ([0], [spec(8, "gathering")], "same track"),
        ([0, 1], [spec(8)], "1 specs are given for 2 matches"),
    ):
        with pytest.raises(MatchSetupError, match=error):
            batch.restart(rows, specs, [MEADOW] * len(rows))
    for rows in ([2], [-1], [0, 0]):
        with pytest.raises(ValueError, match="must be different and of 0 to 1"):
            batch.restart(rows, [spec(8)] * len(rows), [MEADOW] * len(rows))
    assert [row_of(batch, row) for row in range(2)] == before


@pytest.mark.parametrize("kept", ["maps", "bytes"])
def test_a_bank_drops_maps_that_nobody_plays_on_when_it_has_too_many(
    kept: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second, third, fourth = maps = [map_from(flat_world()) for _ in range(4)]
    if kept == "bytes":
        monkeypatch.setattr("wildscav_engine.maps.bank.MEMORY", 3 * first.memory)
    bank = MapBank([first, second], limit=3 if kept == "maps" else 100)
    bank.add([second, third, fourth], in_use=[second, third, fourth])
    assert sorted(bank.index_of(game_map) for game_map in maps[1:]) == [0, 1, 2]
    with pytest.raises(KeyError):
        bank.index_of(first)
