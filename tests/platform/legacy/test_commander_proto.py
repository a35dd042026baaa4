"""The messages of the original's contract: generated code that is up to date and collides with no other."""

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.platform.legacy.helpers.original import SCRIPTS, environment

from wildscav_legacy import commander_pb2

PLATFORM = Path(__file__).parents[3] / "platform"


def test_the_generated_code_is_up_to_date(tmp_path: Path) -> None:
    name = "wildscav_legacy/commander"
    protoc = [sys.executable, "-m", "grpc_tools.protoc", f"--proto_path={PLATFORM}"]
    subprocess.run(
        [*protoc, f"--python_out={tmp_path}", f"--pyi_out={tmp_path}", f"{name}.proto"], check=True
    )
    for suffix in (".py", ".pyi"):
        new, old = ((root / f"{name}_pb2{suffix}").read_text() for root in (tmp_path, PLATFORM))
        assert lines_of(old) == lines_of(new), f"{name}_pb2{suffix} is old: run make proto"


def lines_of(code: str) -> list[str]:
    # The version of the generator is in some of them.
    return [line for line in code.splitlines() if "ersion" not in line and not line.strip(" ,").isdigit()]


def test_messages_of_ours_can_be_loaded_beside_the_originals() -> None:
    file = commander_pb2.DESCRIPTOR
    assert file.name == "wildscav_legacy/commander.proto"
    assert file.package == "wildscav.legacy"


# What version 0.0.3 of the client does not know of ours, by the names of the fields that lead there.
NEW_IN_1_0_0 = {
    f"agent_obs_list.{name}"
    for name in (
        *("can_pickup", "hit_enemy_id", "hit_by_enemy_id", "image"),
        *(f"enemy_info_list.{field}" for field in ("hp", "enemy_id", "is_respawn", "is_invincible")),
    )
}


def test_messages_are_those_of_the_client_but_for_what_is_new_in_1_0_0() -> None:
    done = subprocess.run(
        [environment(), SCRIPTS / "messages.py"], check=True, stdout=subprocess.PIPE, text=True
    )
    theirs = json.loads(done.stdout)
    ours = {name: getattr(commander_pb2, name).DESCRIPTOR for name in ("Request", "Reply")}
    assert set(differences(theirs["Request"], ours["Request"])) == NEW_IN_1_0_0
    assert set(differences(theirs["Reply"], ours["Reply"])) == set()


def differences(theirs: dict[str, Any], ours: Any, path: str = "") -> Iterator[str]:
    """Yield the fields that only one of two messages has, or that they have otherwise."""
    known = {str(field.number): field for field in ours.fields}
    for number in theirs.keys() | known.keys():
        here, there = known.get(number), theirs.get(number)
        if here is None or there is None or not is_same(here, there):
            yield path + (there["name"] if here is None else here.name)
        elif here.message_type:
            yield from differences(there["fields"], here.message_type, f"{path}{here.name}.")


def is_same(field: Any, there: dict[str, Any]) -> bool:
    values = field.enum_type and {value.name: value.number for value in field.enum_type.values}
    told = (field.name, field.type, field.is_repeated, values)
    return told == (there["name"], there["type"], there["repeated"], there["values"])


def test_fields_that_are_new_have_the_numbers_of_1_0_0() -> None:
    numbers = {field.name: field.number for field in commander_pb2.Observation.DESCRIPTOR.fields}
    assert numbers["can_pickup"] == 16
    assert [numbers[name] for name in ("hit_enemy_id", "hit_by_enemy_id", "image")] == [22, 23, 24]
    enemy = [field.name for field in commander_pb2.EnemyInfo.DESCRIPTOR.fields]
    assert enemy[3:] == ["hp", "enemy_id", "is_respawn", "is_invincible"]
