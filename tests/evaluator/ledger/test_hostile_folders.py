"""Whatever stands in an evaluation's folder, checking it ends with a verdict, never in a crash."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.rescore import recomputed
from wildscav_evaluator.output.identity import read_identity
from wildscav_evaluator.output.record_names import record_paths
from wildscav_evaluator.output.results import read_results
from wildscav_evaluator.scores.audit import discrepancies, read_folder
from wildscav_evaluator.scores.rescore import Replayed, read_file, replay_file

# Values that JSON has: any, and such as are just not right.
WRONG = [0, -1, 10**9, 1e300, "", "ada", "bob", "navigation", "royale", "quick", "/proc/kmsg", [], {}]
ANYTHING = st.sampled_from(WRONG) | st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=4,
)
FILES = ("results.json", "evaluation.json", "ledger.jsonl")

Way = tuple[Any, ...]


@pytest.fixture(scope="module")
def replayed(evaluated: Path) -> list[Replayed]:
    """Its records, played again once."""
    return [replay_file(read_file(path)) for path in record_paths(evaluated)]


@pytest.fixture(scope="module")
def folder(evaluated: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(shutil.copytree(evaluated, tmp_path_factory.mktemp("hostile") / "out"))


def ways(value: Any, way: Way = ()) -> list[Way]:
    """Return the ways to all values in a value of JSON."""
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [way, *(found for key, part in inside for found in ways(part, (*way, key)))]


def put(value: Any, way: Way, other: Any) -> Any:
    """Return a value of JSON with another one at the end of a way."""
    if not way:
        return other
    copy = dict(value) if isinstance(value, dict) else list(value)
    copy[way[0]] = put(copy[way[0]], way[1:], other)
    return copy


def audit(out: Path, replayed: Sequence[Replayed]) -> list[str]:
    """Check a folder as `wildscav verify` does, but for playing its records, and return what it says."""
    try:
        told = read_results(out / "results.json")
        checked = read_folder(out, told, None)
        found = recomputed(out, replayed, told, read_identity(out))
        return list(discrepancies(checked, replayed, found))
    except (UserError, OSError) as error:
        return [str(error)]


def test_a_folder_as_it_was_written_is_borne_out(evaluated: Path, replayed: list[Replayed]) -> None:
    assert audit(evaluated, replayed) == []


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_value_anywhere_is_noticed_and_breaks_nothing(
    evaluated: Path, folder: Path, replayed: list[Replayed], data: st.DataObject
) -> None:
    name = data.draw(st.sampled_from(FILES))
    whole = (evaluated / name).read_bytes()
    lines = whole.splitlines() if name.endswith(".jsonl") else [whole]
    number = data.draw(st.integers(0, len(lines) - 1))
    content = json.loads(lines[number])
    way = data.draw(st.sampled_from(ways(content)))
    other = put(content, way, data.draw(ANYTHING))
    lines[number] = json.dumps(other).encode()
    try:
        (folder / name).write_bytes(b"\n".join(lines) + b"\n")
        said = audit(folder, replayed)
    finally:
        (folder / name).write_bytes(whole)
    # The same JSON in another form is the same evaluation.json, and another ledger.
    assert said or other == content or name == "evaluation.json"
    assert not any("\n" in line for line in said)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), name=st.sampled_from(FILES), junk=st.binary(max_size=40))
def test_damage_anywhere_is_noticed_and_breaks_nothing(
    evaluated: Path, folder: Path, replayed: list[Replayed], data: st.DataObject, name: str, junk: bytes
) -> None:
    whole = (evaluated / name).read_bytes()
    start = data.draw(st.integers(0, len(whole)))
    end = data.draw(st.integers(start, min(len(whole), start + 60)))
    try:
        (folder / name).write_bytes(whole[:start] + junk + whole[end:])
        said = audit(folder, replayed)
    finally:
        (folder / name).write_bytes(whole)
    assert said or whole[start:end] == junk or name == "evaluation.json"
    assert not any("\n" in line for line in said)
