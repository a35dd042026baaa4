"""The reference of the protocol: every service and message with its comments, from ``match.proto``."""

import re
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
    MethodDescriptorProto,
    ServiceDescriptorProto,
)
from grpc_tools import protoc

import wildscav
from wildscav_website.markdown import code, table

PROTO = Path(wildscav.__file__).parent / "proto" / "match.proto"
HEAD = """# Protocol

This page is generated from `platform/wildscav/proto/match.proto` and its comments. The [SDK](sdk.md)
implements the protocol for agents in Python; [agents in other
languages](../submitting.md#agents-in-other-languages) shows how to speak it.
"""
# Numbers of fields in descriptors, which make up the paths of comments.
MESSAGES, ENUMS, SERVICES = 4, 5, 6
FIELDS, METHODS, VALUES, INNER_ENUMS = 2, 2, 2, 4
Path_ = tuple[int, ...]
Comments = Mapping[Path_, str]


def page() -> str:
    """Return the page."""
    file = described(PROTO)
    places = file.source_code_info.location
    comments = {tuple(place.path): place.leading_comments for place in places if place.leading_comments}
    opening = next(place.leading_detached_comments for place in places if place.leading_detached_comments)
    lines = [HEAD, prose("\n".join(opening)), "## Services\n"]
    for number, service in enumerate(file.service):
        lines += _service(service, comments, (SERVICES, number))
    lines.append("## Messages\n")
    for number, message in enumerate(file.message_type):
        lines += _message(message, comments, (MESSAGES, number))
    return "\n".join(lines)


def described(proto: Path) -> FileDescriptorProto:
    """Return the descriptor of a .proto file, its comments included.

    Raises:
        ValueError: The file is not valid.
    """
    with TemporaryDirectory() as folder:
        out = Path(folder) / "described"
        standard = files("grpc_tools") / "_proto"
        arguments = [f"-I{proto.parent}", f"-I{standard}", "--include_source_info", "--include_imports"]
        if protoc.main(["protoc", *arguments, f"--descriptor_set_out={out}", proto.name]):
            raise ValueError(f"{proto} is not valid")
        return FileDescriptorSet.FromString(out.read_bytes()).file[-1]


def prose(comment: str) -> str:
    """Return a comment as Markdown, with indented blocks as preformatted text."""
    lines = [line.removeprefix(" ").rstrip() for line in comment.splitlines()]
    text = re.sub(r"(?m)^(?=[^\s])", "", "\n".join(lines))
    blocks = []
    for block in re.split(r"\n{2,}(?=\S)|(?<=\n)\n+(?=\s)", text):
        set_in = block.startswith("  ")
        blocks.append(f"```text\n{block}\n```" if set_in else block.strip("\n"))
    return "\n\n".join(blocks) + "\n"


def _service(service: ServiceDescriptorProto, comments: Comments, path: Path_) -> Iterator[str]:
    yield f"### {service.name}\n\n{prose(comments.get(path, ''))}"
    rows = [
        (code(method.name), *_sides(method), comments.get((*path, METHODS, number), ""))
        for number, method in enumerate(service.method)
    ]
    yield table(("call", "takes", "returns", "what it does"), rows)


def _sides(method: MethodDescriptorProto) -> tuple[str, str]:
    """Return the types that a call takes and returns."""
    takes, gives = _link(method.input_type), _link(method.output_type)
    return ("stream of " * method.client_streaming + takes, "stream of " * method.server_streaming + gives)


def _message(message: DescriptorProto, comments: Comments, path: Path_) -> Iterator[str]:
    yield f"### {message.name}\n\n{prose(comments.get(path, ''))}"
    rows = [
        (
            str(field.number),
            code(field.name),
            _type(field, message),
            comments.get((*path, FIELDS, number), ""),
        )
        for number, field in enumerate(message.field)
    ]
    yield table(("no.", "field", "type", "what it is"), rows)
    for number, enum in enumerate(message.enum_type):
        yield from _enum(f"{message.name}.{enum.name}", enum, comments, (*path, INNER_ENUMS, number))


def _enum(name: str, enum: EnumDescriptorProto, comments: Comments, path: Path_) -> Iterator[str]:
    yield f"### {name}\n\n{prose(comments.get(path, ''))}"
    rows = [
        (str(value.number), code(value.name), comments.get((*path, VALUES, number), ""))
        for number, value in enumerate(enum.value)
    ]
    yield table(("no.", "value", "what it is"), rows)


def _type(field: FieldDescriptorProto, message: DescriptorProto) -> str:
    """Return the type of a field as the .proto file writes it, with a link to a message."""
    for inner in message.nested_type:
        if inner.options.map_entry and field.type_name.endswith(f".{message.name}.{inner.name}"):
            key, value = inner.field
            return f"map of {_type(key, message)} to {_type(value, message)}"
    scalar = FieldDescriptorProto.Type.Name(field.type).removeprefix("TYPE_").lower()
    name = _link(field.type_name) if field.type_name else code(scalar)
    if field.label == FieldDescriptorProto.LABEL_REPEATED:
        return f"repeated {name}"
    return f"optional {name}" if field.proto3_optional else name


def _link(full_name: str) -> str:
    """Return a link to the entry of a message or an enum."""
    name = full_name.rsplit(".v1.", maxsplit=1)[-1]
    return f"[`{name}`](#{name.lower().replace('.', '')})"
