"""The reference of what an agent imports.

Fields are described by the comments beside them, everything else by docstrings.
"""

import ast
import importlib
import inspect
import re
import sys
import textwrap
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import NamedTuple

from wildscav_website.field_comments import meaning_of
from wildscav_website.markdown import code, prose, sentence, table

HEAD = """# The SDK

Everything that an agent imports, with every field and its unit. [Submitting](../submitting.md) says how you
package an agent and how it is judged, [sensors](../sensors.md) what each sensor reads, with shapes and
dtypes.

Units are metres, seconds and degrees. y is up, x east, z north; the middle of the map is (0, 0). Yaw 0 looks
along +z and grows clockwise seen from above; positive pitch looks down.
"""
# What is described of each module, in the order of the page.
MODULES = {
    "wildscav": (
        *("Agent", "Action", "Observation", "MatchInfo", "VisibleAgent", "SupplyBox", "SupplyWave", "Vector"),
        *("run", "say", "mark", "plot", "WildscavError"),
    ),
    "wildscav.errors": ("AgentError", "RefusedError", "ServerUnreachableError", "UserError"),
    "wildscav.words": ("WordsPlayer", "WordsSeat", "Tool", "Reply"),
    "wildscav.harness.player": ("ModelPlayer", "Course"),
    "wildscav.harness.settings": ("ModelSettings", "read_settings"),
    "wildscav.harness.spending": ("Spending", "Ending"),
    "wildscav.keyboard": ("KeysPlayer", "KeysSeat", "Frame"),
    "wildscav.policy": (
        "PolicyAgent",
        "Policy",
        "Environment",
        "Network",
        "Choose",
        "load_network",
    ),
    "wildscav.policy.keys": ("Keys", "Mouse"),
    "wildscav.skills.gathering": ("Gathering",),
    "wildscav.skills.supplies": ("BoxMemory", "Prospecting"),
    "wildscav.skills.surroundings": ("Surroundings", "Rings"),
    "wildscav.skills.paths": ("find_ways", "Ways", "Way"),
    "wildscav.skills.walking": ("WayWalker", "Walk"),
    "wildscav.skills.steering": ("Steering",),
    "wildscav.skills.searching": ("Search", "Boxes", "effort"),
    "wildscav.skills.patience": ("Patience",),
    "wildscav.skills.trained_gathering": ("GatheringPolicyAgent",),
    "wildscav.skills.trained_fighting": ("FightingPolicyAgent", "thinned"),
    "wildscav.skills.scouting": ("Scouting",),
    "wildscav.skills.aiming": (
        "aim_at",
        "will_hit",
        "Aim",
        "look_around",
        "enemies_in_sight",
        "Lookout",
        "max_turn_of",
        "threats_first",
        "velocity_of",
    ),
    "wildscav.skills.fighting": (
        "wants_reload",
        "would_lose",
        "has_much_to_lose",
        "quiet_place",
        "Dodging",
        "steady",
        "cover_from",
        "is_hidden",
    ),
    "wildscav.skills.zone": ("safe_zone", "SafeZone", "Circle"),
}
SECTION = re.compile(r"^(Args|Returns|Raises|Yields|Attributes):$")


class Field(NamedTuple):
    """A field of a class."""

    name: str
    type: str
    default: str
    meaning: str


def page() -> str:
    """Return the page."""
    lines = [HEAD]
    for module, names in MODULES.items():
        for name in names:
            lines += [f"## {name}\n", f"`from {module} import {name}`\n", *_entry(module, name)]
    return "\n".join(lines)


def fields_of(kind: type) -> list[Field]:
    """Return the public fields that the body of a class annotates, in their order."""
    return [
        Field(node.target.id, ast.unparse(node.annotation), _default(node.value), meaning)
        for node, meaning in _body(kind)
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.target.id[0] != "_"
    ]


def values_of(kind: type[Enum]) -> list[tuple[str, str]]:
    """Return the values of an enumeration with their meanings, as cells of a table."""
    return [
        (code(ast.literal_eval(node.value)), sentence(meaning))
        for node, meaning in _body(kind)
        if isinstance(node, ast.Assign)
    ]


def meanings_of(kind: type) -> dict[str, str]:
    """Return what is said of each field of a class, those of its bases in our modules included."""
    ours = [one for one in reversed(kind.__mro__) if one.__module__.startswith("wildscav")]
    written = [one for one in ours if getattr(sys.modules[one.__module__], one.__name__, None) is one]
    return {field.name: field.meaning for one in written for field in fields_of(one)}


def _body(kind: type) -> Iterator[tuple[ast.stmt, str]]:
    """Iterate over the statements in the body of a class, with what is said of each."""
    source = textwrap.dedent(inspect.getsource(kind))
    (definition,) = ast.parse(source).body
    assert isinstance(definition, ast.ClassDef)  # noqa: S101 - what a class's source is
    lines = source.splitlines()
    for node in definition.body:
        yield node, meaning_of(lines, node.lineno, node.end_lineno or node.lineno)


def _entry(module: str, name: str) -> Iterator[str]:
    thing = getattr(importlib.import_module(module), name)
    if inspect.isclass(thing):
        yield from _class(thing)
    elif inspect.isfunction(thing):
        yield f"```python\n{_signature(thing)}\n```\n"
        yield _text(inspect.getdoc(thing) or "")
    else:
        yield from _alias(module, name)


def _class(kind: type) -> Iterator[str]:
    yield _text(inspect.getdoc(kind) or "")
    if issubclass(kind, Enum):
        yield table(("value", ""), values_of(kind))
        return
    yield table(
        ("field", "type", "default", ""),
        [
            (code(field.name), code(field.type), code(field.default), prose(field.meaning))
            for field in fields_of(kind)
        ],
    )
    for name, member in vars(kind).items():
        if name.startswith("_") or not inspect.getdoc(member):
            continue
        if isinstance(member, property) and member.fget is not None:
            returns = inspect.signature(member.fget).return_annotation
            yield f"### {kind.__name__}.{name}\n\n`{_type(returns)}`\n\n{_text(inspect.getdoc(member) or '')}"
        elif inspect.isfunction(member):
            yield f"### {kind.__name__}.{name}\n\n```python\n{_signature(member)}\n```\n"
            yield _text(inspect.getdoc(member) or "")


def _alias(module: str, name: str) -> Iterator[str]:
    """Describe a name for a type, by its line in the module that defines it."""
    for place in (module, *(one for one in sys.modules if one.startswith("wildscav."))):
        path = getattr(sys.modules.get(place), "__file__", None)
        for line in Path(path).read_text("utf-8").splitlines() if path else ():
            found = re.match(rf"{name}(?:: TypeAlias)? = (.+?)(?:  # (.+))?$", line)
            if found:
                yield f"`{found[1]}`\n\n{sentence(found[2] or '')}\n"
                return


def _signature(function: object) -> str:
    signature = inspect.signature(function)  # type: ignore[arg-type]
    parts = str(signature.replace(return_annotation=signature.empty))
    return f"{function.__name__}{_type(parts)} -> {_type(signature.return_annotation)}"  # type: ignore[attr-defined]


def _type(annotation: object) -> str:
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    text = re.sub(r"\b(?:[a-z_]+\.)+(?=[A-Za-z_])", "", text)
    return re.sub(r"ndarray\[tuple\[Any, \.\.\.\], dtype\[(\w+)\]\]", r"NDArray[\1]", text)


def _default(value: ast.expr | None) -> str:
    if value is None:
        return ""
    if isinstance(value, ast.Call) and ast.unparse(value.func) in ("field", "Field"):
        given = {one.arg: one.value for one in value.keywords}
        factory = given.get("default_factory")
        value = factory.body if isinstance(factory, ast.Lambda) else given.get("default", factory)
    text = ast.unparse(value) if value else ""
    return {"dict": "{}", "list": "[]"}.get(text, text)


def _text(docstring: str) -> str:
    """Return a docstring in Google's style as Markdown: its sections become lists."""
    lines, section = [], ""
    for line in prose(docstring).splitlines():
        found = SECTION.match(line)
        if found:
            section = found[1]
            lines.append(f"{section}:\n")
        elif section in ("Args", "Raises", "Attributes") and re.match(r" {4}\S", line):
            name, _, meaning = line.strip().partition(": ")
            lines.append(f"- `{name}`: {meaning}")
        elif section and line.strip():
            lines.append(f"  {line.strip()}" if section in ("Args", "Raises", "Attributes") else line.strip())
        else:
            lines.append(line)
    return "\n".join(lines) + "\n"
