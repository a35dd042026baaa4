"""The reference of tools: those of seats of words, and the further requests of MCP."""

from collections.abc import Iterator, Mapping
from typing import Any

from wildscav_language.calls import Reason, Tool
from wildscav_language.mcp_server.desk import ACTS
from wildscav_language.tools import TOOLS
from wildscav_website.markdown import code, sentence, table, type_of
from wildscav_website.references.sdk import values_of

HEAD = """# Tools

What a seat of words may call, and what clients of MCP may ask for besides, with all arguments. The guides are
[seats of words](../language.md) and [MCP](../mcp.md).

## Tools of a seat

Over MCP each of them also takes the handle `seat`, and `thought`: why you do it, in a sentence. Replays show
it, and nobody in the match hears it.
"""


def page() -> str:
    """Return the page."""
    requests = [(name, kind.__doc__ or "", kind.model_json_schema()) for name, (kind, _) in ACTS.items()]
    lines = [HEAD, *(_entry(*_of(tool)) for tool in TOOLS)]
    lines += ["## Why a tool ends\n", table(("reason", ""), values_of(Reason)), "## Requests of MCP\n"]
    return "\n".join([*lines, *(_entry(*one) for one in requests)])


def _of(tool: Tool) -> tuple[str, str, Mapping[str, Any]]:
    return tool.name, tool.description, tool.schema


def _entry(name: str, about: str, schema: Mapping[str, Any]) -> str:
    rows = list(_arguments(schema))
    return f"### {name}\n\n{about}\n\n{table(('argument', 'values', 'default', ''), rows)}"


def _arguments(schema: Mapping[str, Any]) -> Iterator[tuple[str, str, str, str]]:
    for name, field in schema.get("properties", {}).items():
        kinds = [type_of(one) for one in field.get("anyOf", [field]) if one.get("type") != "null"]
        default = field.get("default")
        about = sentence(field.get("description", ""))
        yield code(name), " or ".join(kinds), code("" if default is None else default), about
