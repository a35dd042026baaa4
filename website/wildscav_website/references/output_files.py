"""The reference of the files that evaluations and tournaments write, and of a model's settings."""

from collections.abc import Iterator

from pydantic import BaseModel

from wildscav_engine.specs import thinking
from wildscav_evaluator.ledger import entries
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.output import identity, results
from wildscav_evaluator.ratings import standings
from wildscav_evaluator.tournaments import tournament_file
from wildscav_website.markdown import code, prose, table
from wildscav_website.references.rest import document
from wildscav_website.references.sdk import fields_of

HEAD = """# Files of evaluations and tournaments

Every field of the JSON files in an output folder. [Evaluation](../evaluation.md) and
[tournaments](../tournaments.md) say what they are for.
"""
MODEL = """## Settings of a model

The file of `--model`, and the part `[model]` of a season's settings. [A model for
agents](../evaluation.md#a-model-for-agents) has an example.
"""
# The content of each file, and the modules with its parts.
FILES: dict[str, tuple[type[BaseModel], tuple[object, ...]]] = {
    "results.json": (results.Results, (thinking, results)),
    "tournament.json": (tournament_file.Tournament, (results, standings, tournament_file)),
    "evaluation.json": (identity.Identity, (results, identity)),
    "ledger.jsonl": (entries.Entry, (results, identity, entries)),
}


def page() -> str:
    """Return the page."""
    settings = [(code(one.name), code(one.default), one.meaning) for one in fields_of(ModelSettings)]
    return "\n".join([HEAD, *_files(), MODEL, table(("setting", "default", ""), settings)])


def _files() -> Iterator[str]:
    told: set[str] = set()
    for file, (content, modules) in FILES.items():
        yield f"## {file}\n\n{prose((modules[-1].__doc__ or '').strip())}\n"
        classes = {name: kind for module in modules for name, kind in vars(module).items()}
        schema = content.model_json_schema(mode="serialization")
        parts = {content.__name__: schema, **schema.get("$defs", {})}
        for name, part in parts.items():
            if name not in told and "properties" in part:
                told.add(name)
                yield from document(name, part, classes.get(name))
