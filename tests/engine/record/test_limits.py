"""Records may be anybody's: whatever is in them, to read one has a price that is known."""

import os
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from wildscav_engine.record import (
    FILE_LIMIT,
    Record,
    RecordError,
    check_recordable,
    read_record,
    record_of,
    verify_record,
)
from wildscav_engine.record.format import LAYOUT, decode, encode
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.binary_format import CHUNK, HEADER_LIMIT, decompress, pack, unpack

MIB = 1 << 20
# Any value that JSON has.
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@pytest.fixture(scope="module")
def record() -> Record:
    match = Match(
        MatchSpec(track="navigation", map=MapSpec(config=MapConfig(size=40, houses=0)), time_limit=1.0)
    )
    match.play_out()
    return record_of(match, ["mine"])


def header_of(record: Record) -> dict[str, object]:
    header, _ = unpack(LAYOUT, encode(record))
    return header


def zeros(size: int) -> bytes:
    """So many zeros, packed a thousandfold."""
    packer = zlib.compressobj(9)
    return (
        b"".join(packer.compress(bytes(min(MIB, size - at))) for at in range(0, size, MIB)) + packer.flush()
    )


def zeros_as_arrays(record: Record, steps: int) -> bytes:
    """The bytes of a record of a long match whose arrays are zeros."""
    spec = record.spec.model_copy(update={"time_limit": 86_400.0, "frames_per_action": 1})
    header = header_of(record) | {"spec": spec.model_dump(mode="json"), "steps": steps}
    return pack(LAYOUT, header, zeros(steps * 40))


def test_arrays_beyond_the_limit_are_refused_before_they_are_unpacked(record: Record) -> None:
    data = zeros_as_arrays(record, 4_000_000)
    tracemalloc.start()
    with pytest.raises(RecordError, match="its arrays would have 160000000 bytes, 134217728 are allowed"):
        decode(data)
    assert tracemalloc.get_traced_memory()[1] < 40 * MIB
    tracemalloc.stop()


def test_what_is_unpacked_is_in_memory_once(record: Record) -> None:
    data = zeros_as_arrays(record, steps := 1_000_000)
    assert len(data) < MIB
    tracemalloc.start()
    assert decode(data).steps == steps
    assert tracemalloc.get_traced_memory()[1] < 1.1 * steps * 40 + 4 * MIB
    tracemalloc.stop()


def test_a_header_beyond_the_limit_is_not_parsed() -> None:
    header = {"spec": "x" * HEADER_LIMIT}
    with pytest.raises(RecordError, match=r"its header has 1,048,\d+ bytes, 1,048,576 are allowed"):
        decode(pack(LAYOUT, header, b""))


def test_half_a_million_faults_are_one_short_line(record: Record) -> None:
    header = header_of(record)
    header["spec"] = {"seats": [0] * 500_000}
    with pytest.raises(RecordError, match="500,002 of its values are invalid") as caught:
        decode(pack(LAYOUT, header, b""))
    assert len(str(caught.value)) < 200


def test_what_is_no_plain_file_is_not_waited_for_and_a_long_one_is_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.wsr")
    with pytest.raises(RecordError, match=r"pipe\.wsr: cannot be read: it is not a plain file"):
        read_record(tmp_path / "pipe.wsr")
    with (tmp_path / "long.wsr").open("wb") as file:
        file.truncate(FILE_LIMIT + 1)
    with pytest.raises(RecordError, match="cannot be read: it has more than 136,314,880 bytes"):
        read_record(tmp_path / "long.wsr")


def test_a_match_is_refused_whose_record_could_not_be_read_again() -> None:
    spec = MatchSpec(track="battle", seats=("submission",) * 100, time_limit=4000.0)
    check_recordable(spec)
    with pytest.raises(RecordError, match=r"44,000 steps with 100 seats has a record of up to 134 MiB"):
        check_recordable(spec.model_copy(update={"time_limit": 4400.0}))


def paths_of(value: object) -> list[tuple[object, ...]]:
    """Return the ways to all values in a value of JSON."""
    inside: list[tuple[object, object]] = []
    if isinstance(value, dict):
        inside = list(value.items())
    elif isinstance(value, list):
        inside = list(enumerate(value))
    return [(), *((key, *path) for key, part in inside for path in paths_of(part))]


def changed(value: object, path: tuple[object, ...], put: object) -> object:
    """Return a value of JSON with another one at the end of a way."""
    if not path:
        return put
    copy = dict(value) if isinstance(value, dict) else list(value)  # type: ignore[call-overload]
    copy[path[0]] = changed(copy[path[0]], path[1:], put)
    return copy


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_any_value_in_a_header_is_a_record_or_one_line(record: Record, data: st.DataObject) -> None:
    header = header_of(record)
    path = data.draw(st.sampled_from(paths_of(header)))
    other = changed(header, path, data.draw(ANYTHING))
    if not isinstance(other, dict):
        return
    try:
        packed = pack(LAYOUT, other, bytes(unpack(LAYOUT, encode(record))[1]))
    except UnicodeEncodeError:
        return
    said = ""
    try:
        read = decode(packed)
    except RecordError as error:
        said = str(error)
    else:
        if read.spec == record.spec:
            said = verify_record(read).message
    assert "\n" not in said
    assert len(said) < 2000


@given(data=st.binary(max_size=300))
@example(data=b"WILDSCAV\x02\x00\xff\xff\xff\xff" + bytes(60))
def test_any_bytes_are_one_line(data: bytes) -> None:
    with pytest.raises(RecordError) as caught:
        decode(data)
    assert "\n" not in str(caught.value)


@given(
    size=st.sampled_from([0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK, 5 * CHUNK + 7]),
    seed=st.integers(0, 2**32 - 1),
    shades=st.sampled_from([1, 2, 256]),
)
def test_what_was_packed_comes_out_and_nothing_else_does(size: int, seed: int, shades: int) -> None:
    content = np.random.default_rng(seed).integers(0, shades, size, np.uint8).tobytes()
    packed = zlib.compress(content)
    assert decompress(packed, size) == content
    for wrong, other in ((packed, size + 1), (packed + b"more", size), (packed[:-1], max(size, 1))):
        with pytest.raises(ValueError, match="its arrays do not have the"):
            decompress(wrong, other)
    if size:
        with pytest.raises(ValueError, match="its arrays do not have the"):
            decompress(packed, size - 1)
