"""Pieces of Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table, or an empty string if it has no rows."""
    lines = [f"| {' | '.join(map(cell, row))} |" for row in rows]
    if not lines:
        return ""
    return "\n".join([f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *lines]) + "\n"


def cell(text: str) -> str:
    """Return text as the content of a table's cell."""
    return " ".join(text.split()).replace("|", "\\|")


def code(text: object) -> str:
    """Return text as code, or an empty string for an empty text."""
    return f"`{text}`" if str(text) else ""


def sentence(text: str) -> str:
    """Return a phrase as a sentence."""
    text = text.strip()
    return text[:1].upper() + text[1:] + "." * (bool(text) and text[-1] not in ".:!?")


def prose(docstring: str) -> str:
    """Return the text of a docstring as Markdown."""
    return docstring.replace("``", "`")


def number(value: float) -> str:
    """Return a number as people read it."""
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:g}"


def type_of(schema: Mapping[str, Any]) -> str:
    """Return what a JSON schema allows in a few words, with links to other documents."""
    if "enum" in schema or "const" in schema:
        return ", ".join(map(code, schema.get("enum") or [schema["const"]]))
    if "$ref" in schema:
        name = str(schema["$ref"]).rpartition("/")[2]
        return "any" if name == "JsonValue" else f"[{name}](#{name.lower()})"
    if choices := schema.get("anyOf", schema.get("oneOf")):
        return " or ".join(map(type_of, choices))
    if schema.get("type") == "array":
        return f"list of {type_of(schema.get('items', {}))}"
    if schema.get("type") == "object":
        values = schema.get("additionalProperties")
        kind = type_of(values) if isinstance(values, dict) else "any"
        return "table" if kind == "any" else f"table of {kind}"
    return f"{schema.get('format') or schema.get('type') or 'any'}{_bounds(schema)}"


def _bounds(schema: Mapping[str, Any]) -> str:
    words = {"minimum": " from", "exclusiveMinimum": " above", "maximum": " to", "exclusiveMaximum": " below"}
    told = [
        f"{word} {schema[bound]:,}".removesuffix(".0") for bound, word in words.items() if bound in schema
    ]
    return ",".join(told) if {"exclusiveMinimum", "exclusiveMaximum"} & schema.keys() else "".join(told)


def indented(text: str) -> str:
    """Return text indented as the content of a tab or an admonition."""
    return "\n".join(f"    {line}" if line else "" for line in text.splitlines()) + "\n"
