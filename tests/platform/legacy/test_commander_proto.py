"""The messages of the original's contract: generated code that is up to date and collides with no other."""

import subprocess
import sys
from pathlib import Path

from wildscav.legacy import commander_pb2

PLATFORM = Path(__file__).parents[3] / "platform"


def test_the_generated_code_is_up_to_date(tmp_path: Path) -> None:
    name = "wildscav/legacy/commander"
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
    assert file.name == "wildscav/legacy/commander.proto"
    assert file.package == "wildscav.legacy"


def test_fields_that_differ_between_versions_have_the_numbers_of_1_0_0() -> None:
    numbers = {
        field.name: field.number for field in commander_pb2.Observation.DESCRIPTOR.fields if field.number > 21
    }
    assert numbers == {"hit_enemy_id": 22, "hit_by_enemy_id": 23, "image": 24}
    enemy = [field.name for field in commander_pb2.EnemyInfo.DESCRIPTOR.fields]
    assert enemy[3:] == ["hp", "enemy_id", "is_respawn", "is_invincible"]
