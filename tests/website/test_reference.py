"""The pages of reference tell everything there is, and links of pages lead where they should on the site."""

import re
import subprocess
from pathlib import Path
from typing import Any

import typer

from wildscav.cli.main import app
from wildscav.proto import match_pb2
from wildscav_website import commands, protocol, rest
from wildscav_website.links import links_for_site

ROOT = Path(__file__).parents[2]


def every_command() -> dict[str, Any]:
    """Every command that does something, by all of its words."""
    root: Any = typer.main.get_command(app)
    found = {}
    for name in root.list_commands(None):
        command = root.get_command(None, name)
        members = getattr(command, "commands", None) or {"": command}
        found |= {f"wildscav {name} {member}".strip(): one for member, one in members.items()}
    return found


def test_the_reference_of_commands_tells_every_command_and_option() -> None:
    entries = dict(entry.split("\n", 1) for entry in commands.page().split("\n### ")[1:])
    for path, command in every_command().items():
        for parameter in command.params:
            if parameter.param_type_name == "option" and not parameter.hidden:
                for option in parameter.opts:
                    assert re.search(rf"[` ]{option}[ ,`]", entries[path]), (path, option)


def test_the_reference_of_the_protocol_tells_every_field() -> None:
    entries = dict(entry.split("\n", 1) for entry in protocol.page().split("\n### ")[1:])
    for message in match_pb2.DESCRIPTOR.message_types_by_name.values():
        for field in message.fields:
            assert f"| {field.number} | `{field.name}` |" in entries[message.name], field.full_name
    for service in match_pb2.DESCRIPTOR.services_by_name.values():
        assert all(f"| `{method.name}` |" in entries[service.name] for method in service.methods)


def test_the_reference_of_the_api_tells_every_request_and_every_field_of_its_documents() -> None:
    api, page = rest.described(), rest.page()
    for path, operations in api["paths"].items():
        assert all(f"| `{word.upper()} {path}` |" in page for word in operations)
    entries = dict(entry.split("\n", 1) for entry in page.split("\n### ")[1:])
    for name, schema in api["components"]["schemas"].items():
        assert all(f"| `{field}` |" in entries[name] for field in schema.get("properties", {})), name
    assert "| More than 1 where organizers had it played again. |" in entries["MatchView"]


def test_a_comment_becomes_paragraphs_and_what_is_set_in_stays_as_it_is() -> None:
    comment = " One\n two.\n\n   client    server\n   Join ---> \n\n Three.\n"
    assert protocol.prose(comment) == "One\ntwo.\n\n```text\n  client    server\n  Join --->\n```\n\nThree.\n"


def test_links_that_leave_the_pages_lead_to_where_their_targets_are_on_the_site() -> None:
    added: list[str] = []
    page = "[a](../README.md#install) [b](rules.md) [c](https://example.org/x.md) [d](#e) [f](../Makefile)"
    assert links_for_site(page, "training.md", added.append) == (
        "[a](index.md#install) [b](rules.md) [c](https://example.org/x.md) [d](#e) [f](source/Makefile)"
    )
    assert added == ["Makefile"]
    assert links_for_site("[a](docs/rules.md) [b](LICENSE)", "index.md", added.append) == (
        "[a](rules.md) [b](license.md)"
    )


def test_make_builds_strictly_and_does_not_silence_the_warnings_that_are_counted() -> None:
    # With --quiet, MkDocs counts no warnings, and --strict lets all of them pass.
    done = subprocess.run(["make", "-n", "docs"], cwd=ROOT, capture_output=True, text=True)
    (line,) = [line for line in done.stdout.splitlines() if "mkdocs build" in line]
    assert "--strict" in line
    assert not {"--quiet", "-q"} & set(line.split())
