"""The reference of a season's API: its routes, and its documents with the comments beside their fields."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel

from wildscav_leaderboard.api.routers import api_router
from wildscav_leaderboard.webhooks.delivery import MAX_ATTEMPTS, MAX_LOST
from wildscav_website.markdown import code, prose, sentence, table, type_of
from wildscav_website.references.sdk import meanings_of

HEAD = """# The API of seasons

Every season answers these requests at its own address, and describes them at `/api/v1/openapi.json`.
A request that needs an account has the header `Authorization: Bearer TOKEN` with a
[token of the account](../competing.md#in-scripts). A request that is refused gets an [ErrorView](#errorview).
"""
SECONDS = re.compile(r"^s\b")  # the unit, as comments begin with it
NONE = re.compile(r"\bNone(?=:| (?:after|before|for|if|in|until|where|while)\b)")  # Python's null
WEBHOOKS = f"""## Webhooks

A team's webhook gets a `POST` with a JSON document when the state of one of its submissions changes: `type`
(such as `submission.active`), `timestamp`, and `data`. Messages are signed as
[Standard Webhooks](https://www.standardwebhooks.com) says, with the secret that is shown when the webhook
is made. A message that does not arrive is sent up to {MAX_ATTEMPTS} times, over hours, with the same
identifier. A webhook that loses {MAX_LOST} messages in a row is disabled.
"""
BREAK = "\n\n"  # between paragraphs
WORDS = ("get", "post", "put", "patch", "delete")


def described() -> dict[str, Any]:
    """Return the description of the API, as a season gives it."""
    app = FastAPI()
    app.include_router(api_router())
    return app.openapi()


def page() -> str:
    """Return the page."""
    api = described()
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for path, operations in api["paths"].items():
        for word in filter(operations.get, WORDS):
            one = operations[word]
            groups.setdefault(one["tags"][0], []).append(_route(path, word, one))
    lines = [HEAD]
    for tag, routes in groups.items():
        lines += [f"## {tag.capitalize()}\n", table(("request", "what it does", "takes and answers"), routes)]
    lines += [WEBHOOKS, "## Documents\n"]
    models = _models()
    for name, schema in api["components"]["schemas"].items():
        lines += document(name, schema, models.get(name)) if "properties" in schema else []
    return "\n".join(lines)


def _route(path: str, word: str, one: Mapping[str, Any]) -> tuple[str, str, str]:
    """Return a request, what it does, and what it takes and answers."""
    taken = [code(parameter["name"]) for parameter in one.get("parameters", ()) if parameter["in"] == "query"]
    taken += _named(one.get("requestBody", {}))
    answers = [
        name for status in one["responses"] if status[0] == "2" for name in _named(one["responses"][status])
    ]
    return (
        code(f"{word.upper()} {path}"),
        _sentence(one.get("description", "").split(BREAK)[0]),
        ", ".join(taken) + (f" → {', '.join(answers)}" if answers else ""),
    )


def _named(body: Mapping[str, Any]) -> list[str]:
    """Return links to the documents of a request or of an answer."""
    types = [type_of(content.get("schema", {})) for content in body.get("content", {}).values()]
    return [kind for kind in types if "](#" in kind]


def document(name: str, schema: Mapping[str, Any], model: type[BaseModel] | None) -> Iterator[str]:
    """Describe a document: its fields, with what the code says beside them."""
    meanings = meanings_of(model) if model else {}
    rows = [
        (
            code(field),
            type_of(of),
            _sentence(of.get("description") or SECONDS.sub("seconds", meanings.get(field, ""))),
        )
        for field, of in schema.get("properties", {}).items()
    ]
    yield f"### {name}\n\n{_sentence(schema.get('description', '').split(BREAK)[0])}\n"
    yield table(("field", "type", ""), rows)


def _sentence(text: str) -> str:
    return sentence(NONE.sub("`null`", prose(text)))


def _models() -> dict[str, type[BaseModel]]:
    """Return the classes of documents by their names."""
    found: dict[str, type[BaseModel]] = {}
    waiting: list[type[BaseModel]] = [BaseModel]
    while waiting:
        for kind in waiting.pop().__subclasses__():
            found[kind.__name__] = kind
            waiting.append(kind)
    return found
