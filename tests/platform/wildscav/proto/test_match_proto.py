"""The protocol file: explained in full, and the same as the code generated from it."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from google.protobuf.descriptor_pb2 import DescriptorProto, FileDescriptorProto, FileDescriptorSet

from wildscav.proto import match_pb2, match_pb2_grpc

ROOT = Path(__file__).parents[4]


def generate(tmp_path: Path) -> FileDescriptorProto:
    """Generate all code anew, and return the file's description with its comments."""
    descriptors = tmp_path / "match.bin"
    subprocess.run(
        [
            *(sys.executable, "-m", "grpc_tools.protoc", f"--proto_path={ROOT / 'platform'}"),
            *(f"--python_out={tmp_path}", f"--pyi_out={tmp_path}", f"--grpc_python_out={tmp_path}"),
            *("--include_source_info", f"--descriptor_set_out={descriptors}"),
            "wildscav/proto/match.proto",
        ],
        check=True,
    )
    (file,) = FileDescriptorSet.FromString(descriptors.read_bytes()).file
    return file


def test_the_generated_code_is_up_to_date(tmp_path: Path) -> None:
    file = generate(tmp_path)
    file.ClearField("source_code_info")
    committed = FileDescriptorProto()
    match_pb2.DESCRIPTOR.CopyToProto(committed)
    assert without_json_names(file) == without_json_names(committed)
    for name in ("match_pb2.pyi", "match_pb2_grpc.py"):
        new = (tmp_path / "wildscav" / "proto" / name).read_text()
        old = (ROOT / "platform" / "wildscav" / "proto" / name).read_text()
        assert without_versions(old) == without_versions(new), f"{name} is old: run make proto"


def without_json_names(file: FileDescriptorProto) -> FileDescriptorProto:
    def strip(message: DescriptorProto) -> None:
        for field in message.field:
            field.ClearField("json_name")
        for nested in message.nested_type:
            strip(nested)

    for message in file.message_type:
        strip(message)
    return file


def without_versions(code: str) -> list[str]:
    return [line for line in code.splitlines() if "VERSION = " not in line]


def test_everything_in_the_protocol_is_explained(tmp_path: Path) -> None:
    file = generate(tmp_path)
    comments = {tuple(place.path): place.leading_comments.strip() for place in file.source_code_info.location}
    things = dict(named(file))
    assert len(things) > 100
    for path, name in things.items():
        comment = comments.get(path, "")
        assert len(comment) > 8, f"{name} has no comment"
        assert comment.endswith("."), f"{name}: {comment!r} is no sentence"


def named(file: FileDescriptorProto) -> Iterator[tuple[tuple[int, ...], str]]:
    """Yield the path of every service, method, message, enum and field in the file's source, and its name."""
    for index, service in enumerate(file.service):
        yield (6, index), service.name
        for place, method in enumerate(service.method):
            yield (6, index, 2, place), f"{service.name}.{method.name}"
    for index, message in enumerate(file.message_type):
        yield from parts((4, index), message)


def parts(path: tuple[int, ...], message: DescriptorProto) -> Iterator[tuple[tuple[int, ...], str]]:
    yield path, message.name
    for index, field in enumerate(message.field):
        yield (*path, 2, index), f"{message.name}.{field.name}"
    chosen = [field for field in message.field if field.HasField("oneof_index") and not field.proto3_optional]
    for index in {field.oneof_index for field in chosen}:
        yield (*path, 8, index), f"{message.name}.{message.oneof_decl[index].name}"
    for index, enum in enumerate(message.enum_type):
        yield (*path, 4, index), enum.name
        for place, value in enumerate(enum.value):
            yield (*path, 4, index, 2, place), value.name


def test_the_package_carries_the_version() -> None:
    from wildscav.proto import PROTOCOL_VERSION

    assert match_pb2.DESCRIPTOR.package == f"wildscav.match.v{PROTOCOL_VERSION}"
    assert match_pb2_grpc.MatchStub is not None
