"""Bases: they are found by their digest; damaged ones are refused in one line."""

import json
import re
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import box

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import MapError, base
from wildscav_engine.maps.base import Base, BaseError, decode, digest_of, encode, load_base, save_base
from wildscav_engine.storage import binary_format as container

NONE = "0" * 32  # the digest of no base
HEIGHTS = np.linspace(-3.0, 12.5, 21 * 21).reshape(21, 21)
SOLIDS = (box((-5, 0, -5), (5, 3, 5)), box((10, 1, 10), (21, 2, 12), Kind.ROCK))
COUNTRY = Base(HEIGHTS, -1.5, SOLIDS, 40, "country")


@pytest.fixture(autouse=True)
def maps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of bases."""
    monkeypatch.setenv("WILDSCAV_MAPS", str(tmp_path / "maps"))
    return tmp_path / "maps"


@pytest.mark.parametrize(
    "country", [COUNTRY, Base(None, -np.inf, (), 2000, ""), COUNTRY._replace(heights=None)]
)
def test_a_base_reads_back_as_it_was_written(country: Base, maps: Path) -> None:
    digest, path = save_base(country)
    again = load_base(digest)

    assert path == maps / f"{digest}.wsb"
    assert (again.water_level, again.size, again.name) == country[1:2] + country[3:]
    np.testing.assert_equal(again.heights, country.heights)
    for one, other in zip(again.solids, country.solids, strict=True):
        np.testing.assert_equal(vars(one), vars(other))


def test_anything_that_differs_is_another_base() -> None:
    higher = COUNTRY._replace(heights=HEIGHTS + 1e-9)
    others = [COUNTRY, higher, COUNTRY._replace(water_level=0.0), COUNTRY._replace(solids=SOLIDS[:1])]
    others += [COUNTRY._replace(name="other"), COUNTRY._replace(heights=None)]

    assert len({digest_of(other) for other in others}) == len(others)


def test_a_user_without_a_home_needs_a_folder_for_bases(maps: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody(_: int) -> None:
        raise KeyError

    monkeypatch.setattr("pwd.getpwuid", nobody)
    monkeypatch.delenv("HOME")
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    assert base.folders() == [maps]
    monkeypatch.delenv("WILDSCAV_MAPS")
    with pytest.raises(MapError, match=r"^this user has no home directory: name a folder for maps in W"):
        save_base(COUNTRY)


def test_a_base_is_found_in_any_of_the_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    digest, _ = save_base(COUNTRY)
    monkeypatch.setenv("WILDSCAV_MAPS", f"{tmp_path / 'nothing'}::{tmp_path / 'maps'}")
    assert digest_of(load_base(digest)) == digest


@pytest.mark.parametrize("named", ["", None])
def test_without_a_named_folder_the_users_own_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: str | None
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.delenv("WILDSCAV_MAPS")
    if named is not None:
        monkeypatch.setenv("WILDSCAV_MAPS", named)
    assert base.folders() == [tmp_path / "wildscav" / "maps"]
    monkeypatch.delenv("XDG_DATA_HOME")
    assert base.folders() == [Path.home() / ".local/share/wildscav/maps"]


def test_a_base_that_is_not_there_says_how_to_bring_it_in(maps: Path) -> None:
    said = (
        f"base is {NONE}: no imported map with this digest in {maps}; bring it in with: wildscav map import"
    )
    with pytest.raises(MapError, match=f"^{re.escape(said)}$"):
        load_base(NONE)


def test_a_base_under_the_name_of_another_is_refused() -> None:
    _, path = save_base(COUNTRY)
    path.rename(path.with_name(f"{NONE}.wsb"))
    with pytest.raises(MapError, match=f"base is {NONE}: .* holds another map"):
        load_base(NONE)


@given(st.data())
def test_damage_anywhere_is_one_clear_line(data: st.DataObject) -> None:
    raw = bytearray(encode(COUNTRY))
    if data.draw(st.booleans()):
        raw = raw[: data.draw(st.integers(0, len(raw) - 1))]
    else:
        raw[data.draw(st.integers(0, len(raw) - 1))] ^= data.draw(st.integers(1, 255))
    assert re.fullmatch(".+", refusal(bytes(raw)))


def refusal(data: bytes) -> str:
    """Return the message with which some bytes are refused; other errors pass through."""
    try:
        decode(data)
    except BaseError as error:
        return str(error)
    return ""


NUMBERS = st.floats() | st.integers() | st.none() | st.text(max_size=3) | st.booleans()


@given(
    st.fixed_dictionaries(
        {},
        optional={
            "size": NUMBERS,
            "water_level": NUMBERS,
            "ground": NUMBERS,
            "kinds": st.lists(NUMBERS) | NUMBERS,
            "faces": st.lists(NUMBERS) | NUMBERS,
        },
    ),
    st.binary(max_size=64) | st.none(),
)
def test_a_hostile_base_with_a_right_checksum_is_no_traceback(
    change: dict[str, object], payload: bytes | None
) -> None:
    header, packed = container.unpack(base.LAYOUT, encode(COUNTRY))
    packed = packed if payload is None else memoryview(zlib.compress(payload))
    assert "\n" not in refusal(container.pack(base.LAYOUT, {**header, **change}, packed))


def test_a_bomb_is_refused_without_unpacking_it() -> None:
    header, _ = container.unpack(base.LAYOUT, encode(COUNTRY))
    with pytest.raises(BaseError, match="do not have the"):
        decode(container.pack(base.LAYOUT, header, zlib.compress(bytes(1 << 28))))


@pytest.mark.parametrize(
    ("change", "said"), [({"size": 100_000}, "more than"), ({"kinds": []}, "0 kinds of 2 solids")]
)
def test_a_header_that_its_arrays_cannot_follow_is_refused(change: dict[str, object], said: str) -> None:
    header, packed = container.unpack(base.LAYOUT, encode(COUNTRY))
    with pytest.raises(BaseError, match=said):
        decode(container.pack(base.LAYOUT, {**header, **change}, packed))


def test_a_header_of_endless_brackets_is_refused() -> None:
    body = container.PREAMBLE.pack(base.LAYOUT.magic, base.LAYOUT.version, 100_000) + b"[" * 100_000
    with pytest.raises(BaseError, match="not valid"):
        decode(body + container.blake2b(body, digest_size=32).digest())


UNIT_BOX = box((0, 0, 0), (1, 1, 1))
PLANES = UNIT_BOX.planes


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"size": 41}, "size is 41, must be an even number"),
        ({"size": 38}, "size is 38, must be an even number"),
        ({"size": 2002}, "size is 2002"),
        ({"size": 42}, r"its ground is \(21, 21\), must be \(22, 22\)"),
        ({"heights": np.full((21, 21), np.nan)}, "not everywhere from -1000 to 1000 m"),
        ({"heights": np.full((21, 21), 1e9)}, "not everywhere from -1000 to 1000 m"),
        ({"water_level": np.nan}, "water level is nan m"),
        ({"water_level": np.inf}, "water level is inf m"),
        ({"name": "x" * 81}, "81 characters, 80 are allowed"),
        ({"solids": (box((30, 0, 0), (41, 1, 1)),)}, "a part lies outside the map of 40 m"),
        ({"solids": (box((21, 0, 0), (22, 1, 1)),)}, "a part lies outside the map of 40 m"),
        ({"solids": (box((0, 0, 0), (1, 1001, 1)),)}, "a part lies outside the map of 40 m"),
        ({"solids": (replace(UNIT_BOX, planes=PLANES[:3]),)}, "3 to 3 faces, must have 4 to 100"),
        ({"solids": (replace(UNIT_BOX, planes=np.tile(PLANES, (17, 1))),)}, "102 to 102 faces"),
        ({"solids": (replace(UNIT_BOX, planes=PLANES * 2),)}, "no unit normal"),
        ({"solids": (replace(UNIT_BOX, planes=PLANES * np.nan),)}, "no unit normal"),
        ({"solids": (replace(UNIT_BOX, high=np.zeros(3)),)}, "has no volume"),
        ({"solids": (UNIT_BOX,) * 20_001}, "20001 parts, 20000 are allowed"),
    ],
)
def test_what_no_map_can_hold_is_neither_written_nor_read(change: dict[str, object], said: str) -> None:
    wrong = COUNTRY._replace(**change)
    with pytest.raises(BaseError, match=said):
        save_base(wrong)
    with pytest.raises(BaseError):
        decode(encode(wrong))


def test_parts_that_all_cover_the_whole_map_are_refused() -> None:
    cover = box((-1000, 0, -1000), (1000, 1, 1000))
    with pytest.raises(BaseError, match=r"cover .* cells of 2 m, 20000000 are allowed"):
        base.check_base(Base(None, -np.inf, (cover,) * 20, 2000, ""))


def test_a_base_of_another_version_says_so() -> None:
    header, packed = container.unpack(base.LAYOUT, encode(COUNTRY))
    later = container.pack(base.LAYOUT._replace(version=7), header, packed)
    with pytest.raises(BaseError, match="format version 7, of a later engine; this one reads version 1"):
        decode(later)


def test_what_is_no_base_is_named(maps: Path) -> None:
    maps.mkdir()
    path = maps / f"{NONE}.wsb"
    path.write_text(json.dumps({"hello": "world"}) * 10)
    with pytest.raises(MapError, match=f"base is {NONE}: .*: not an imported map"):
        load_base(NONE)
