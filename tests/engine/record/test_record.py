"""Records: what they keep, and what verification finds."""

import base64
import dataclasses
import math
import resource
import zlib
from collections.abc import Callable
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.engine.versions.pins import read_pins

from wildscav_engine import SIMULATION_VERSION
from wildscav_engine.maps import GENERATOR_VERSION, generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record import (
    Record,
    RecordError,
    read_record,
    record_of,
    save,
    verify_record,
    write_record,
)
from wildscav_engine.record.format import LAYOUT, decode, encode
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.binary_format import PREAMBLE, canonical_json, pack, unpack
from wildscav_engine.version import advice


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, houses=2), 8)


@pytest.fixture(scope="module")
def record(country: GameMap) -> Record:
    seats = ("submission", "fighter", "gatherer")
    match = Match(MatchSpec(track="battle", map=country.spec, seed=3, seats=seats, time_limit=8), country)
    random = np.random.default_rng(0)
    while not match.over:
        rows = random.uniform(0, 1, (3, 8)).astype(np.float32)
        rows[:, 0], rows[:, 1] = random.uniform(-180, 180, 3), random.uniform(0, 10, 3)
        match.step(rows)
    return record_of(match, ["mine", "fighter", "gatherer"])


def test_a_record_reads_back_as_it_was_written(record: Record, tmp_path: Path) -> None:
    path = tmp_path / "match.wsr"
    save(record, path)
    again = read_record(path)
    for field in {field.name for field in dataclasses.fields(record)} - {"actions", "digests"}:
        assert getattr(again, field) == getattr(record, field)
    assert again.simulation_version == SIMULATION_VERSION
    assert (again.actions == record.actions).all()
    assert (again.digests == record.digests).all()
    assert [file.name for file in tmp_path.iterdir()] == ["match.wsr"]
    assert path.stat().st_size < 64 * record.steps * 3 / 2
    assert verify_record(again) == (True, None, "holds: 80 steps")


@settings(max_examples=25)
@given(st.integers(0, 79), st.integers(0, 2), st.integers(0, 31), st.integers(0, 7))
def test_one_changed_bit_of_an_action_is_found_even_with_a_new_checksum(
    record: Record, country: GameMap, step: int, seat: int, byte: int, bit: int
) -> None:
    actions = record.actions.copy()
    actions[step, seat].view(np.uint8)[byte] ^= 1 << bit
    forged = decode(encode(dataclasses.replace(record, actions=actions)))
    verification = verify_record(forged, country)
    assert not verification.holds
    assert verification.step == step + 1


def with_digest(record: Record, step: int) -> Record:
    digests = record.digests.copy()
    digests[step - 1] ^= np.uint64(1)
    return dataclasses.replace(record, digests=digests)


def with_supplies(record: Record) -> Record:
    first, *others = record.result.seats
    seats = (first.model_copy(update={"supplies": 999}), *others)
    return dataclasses.replace(record, result=record.result.model_copy(update={"seats": seats}))


def cut_short(record: Record) -> Record:
    return dataclasses.replace(record, actions=record.actions[:50], digests=record.digests[:50])


@pytest.mark.parametrize(
    ("forge", "step", "message"),
    [
        (lambda record: with_digest(record, 42), 42, "step 42: the state differs"),
        (with_supplies, None, "the result differs"),
        (cut_short, None, "the result differs"),
        (
            lambda record: dataclasses.replace(record, map_digest="0" * 16),
            None,
            f"played on map {'0' * 16}, but this engine",
        ),
    ],
)
def test_what_differs_is_named(
    record: Record, country: GameMap, forge: Callable[[Record], Record], step: int | None, message: str
) -> None:
    verification = verify_record(decode(encode(forge(record))), country)
    assert (verification.holds, verification.step) == (False, step)
    assert message in verification.message


@pytest.mark.parametrize(
    ("kind", "ours"), [("generator", GENERATOR_VERSION), ("simulation", SIMULATION_VERSION)]
)
def test_another_version_is_named_before_the_map_is_made(
    kind: str, ours: int, record: Record, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wildscav_engine.record.verify.map_of", None)
    changes: dict[str, Any] = {f"{kind}_version": 1, "engine_version": "0.0.9"}
    holds, step, message = verify_record(decode(encode(dataclasses.replace(record, **changes))))
    assert (holds, step) == (False, None)
    assert f"{kind} version 1, but this engine has version {ours}: {advice('0.0.9')}" in message


def test_a_record_from_before_the_rules_were_numbered_is_of_version_1(record: Record) -> None:
    raw = encode(record)
    header, payload = unpack(LAYOUT, raw)
    del header["simulation_version"]
    del header["result"]["ending"]
    old = decode(pack(LAYOUT, header, bytes(payload)))
    assert old.simulation_version == 1


def test_a_record_from_before_seats_had_seeds_of_their_own_is_read_and_holds(record: Record) -> None:
    header, payload = unpack(LAYOUT, encode(record))
    del header["seeds"]
    old = decode(pack(LAYOUT._replace(version=2), header, bytes(payload)))
    assert (old.version, old.seeds) == (2, record.seeds)
    assert verify_record(old).holds
    pinned = decode(base64.b64decode(read_pins()["record"]["2"]["a match"]))
    assert (pinned.version, len(pinned.seeds)) == (2, 2)


def test_a_record_has_the_seeds_that_seats_were_told(country: GameMap) -> None:
    match = Match(MatchSpec(track="navigation", map=country.spec, seats=("submission",) * 2), country)
    own = match.start_info(0).seed
    match.seeds = {1: 5}
    assert match.start_info(1).seed == 5
    assert decode(encode(record_of(match, ["one", "two"]))).seeds == (own, 5)


@pytest.mark.parametrize("seeds", [[1, 2], [1, 2, -1], [1, 2, 1 << 63], [1, 2, True], [1, 2, 3.0], None])
def test_seeds_that_no_seat_is_told_are_refused(record: Record, seeds: object) -> None:
    header, payload = unpack(LAYOUT, encode(record))
    with pytest.raises(RecordError, match="not valid"):
        decode(pack(LAYOUT, {**header, "seeds": seeds}, bytes(payload)))


@given(st.data())
def test_damage_anywhere_is_one_clear_line(record: Record, data: st.DataObject) -> None:
    raw = bytearray(encode(record))
    if data.draw(st.booleans()):
        raw = raw[: data.draw(st.integers(0, len(raw) - 1))]
    else:
        raw[data.draw(st.integers(0, len(raw) - 1))] ^= data.draw(st.integers(1, 255))
    with pytest.raises(RecordError) as caught:
        decode(bytes(raw))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("contents", "said"),
    [
        (b"", "not a record"),
        (b"hello world, this is no record at all, but long enough", "not a record"),
        (b"WILDSCAV" + b"\x63\x00" + bytes(60), "format version 99"),
        (
            b"WILDSCAV" + b"\x01\x00" + bytes(60),
            "version 1, of an earlier engine; this one reads version 2 or 3",
        ),
    ],
)
def test_what_is_no_record_is_refused(contents: bytes, said: str, tmp_path: Path) -> None:
    path = tmp_path / "x.wsr"
    path.write_bytes(contents)
    with pytest.raises(RecordError, match=said) as caught:
        read_record(path)
    assert str(path) in str(caught.value)


def test_a_missing_record_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"nowhere\.wsr: .*No such file"):
        read_record(tmp_path / "nowhere.wsr")


def test_a_full_disk_leaves_nothing_behind(record: Record, tmp_path: Path) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, limits[1]))  # Python ignores the signal of it
    try:
        with pytest.raises(OSError, match="File too large"):
            save(record, tmp_path / "cut.wsr")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert not list(tmp_path.iterdir())


def test_a_match_can_be_written_as_it_stands(country: GameMap, tmp_path: Path) -> None:
    match = Match(MatchSpec(track="gathering", map=country.spec, time_limit=5), country)
    match.step()
    write_record(tmp_path / "one.wsr", match, ["me"])
    assert read_record(tmp_path / "one.wsr").steps == 1


@pytest.mark.parametrize(
    ("header", "said"),
    [
        (b"[" * 100_000, "not valid"),
        (b'{"steps":1}', "must have"),
        (b'{ "steps":1}', "canonical form"),
        (b"[]", "not valid"),
        (b"\xff", "not valid"),
        ({"steps": math.inf}, "not valid"),
        ({"steps": 10**9}, "at most 80"),
    ],
)
def test_a_strange_header_with_a_right_checksum_is_refused(
    record: Record, header: bytes | dict[str, Any], said: str
) -> None:
    text = header
    if isinstance(text, dict):
        text = canonical_json({**unpack(LAYOUT, encode(record))[0], **text})
    body = PREAMBLE.pack(LAYOUT.magic, LAYOUT.version, len(text)) + text + zlib.compress(b"")
    with pytest.raises(RecordError, match=said):
        decode(body + blake2b(body, digest_size=32).digest())


def test_a_bomb_is_not_unpacked(record: Record) -> None:
    header, _ = unpack(LAYOUT, encode(record))
    with pytest.raises(RecordError, match="do not have the"):
        decode(pack(LAYOUT, header, zlib.compress(bytes(1 << 24))))
