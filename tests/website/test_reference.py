"""The pages of reference tell everything there is."""

import dataclasses
import functools
import importlib
import inspect
import json
import re
import subprocess
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import typer

import wildscav
import wildscav.policy
from wildscav.cli.main import app
from wildscav.harness.settings import ModelSettings
from wildscav.harness.spending import Ending
from wildscav.proto import match_pb2
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.sensors import SENSORS
from wildscav_engine.specs.map_spec import Country, MapConfig, Placement
from wildscav_evaluator.ledger import entries
from wildscav_evaluator.output import identity, results
from wildscav_evaluator.output.json_files import FileModel
from wildscav_evaluator.ratings import standings
from wildscav_evaluator.tournaments import tournament_file
from wildscav_language.calls import Reason
from wildscav_language.mcp_server.protocol import all_tools
from wildscav_legacy.episode import FIELDS
from wildscav_website.build import examples
from wildscav_website.field_comments import meaning_of
from wildscav_website.markdown import type_of
from wildscav_website.references import (
    commands,
    legacy,
    metrics,
    modules,
    output_files,
    protocol,
    rest,
    sdk,
    sensors,
    tools,
)
from wildscav_website.references.sensors import meanings_of, range_of, shape_of

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


def test_the_page_of_the_original_client_gets_every_field_with_its_default_and_its_range() -> None:
    written = (ROOT / "docs" / "legacy.md").read_text("utf-8")
    assert f"\n{legacy.AFTER}\n" in written
    page = legacy.with_fields(written)
    rows = re.findall(r"^\| `(\w+)` \| ([-\de+.]+) \| ([-\de+.]+) \| ([-\de+.]+) \|", page, re.MULTILINE)
    told = {name: tuple(map(float, numbers)) for name, *numbers in rows}
    assert told == {name: tuple(map(float, number)) for name, number in FIELDS.items()}
    assert "FIELDS" not in page, "the table says it"


def test_the_list_of_modules_says_of_every_system_of_the_game_what_it_does() -> None:
    page = modules.page()
    for file in (ROOT / "engine" / "wildscav_engine" / "simulation" / "systems").glob("[a-z]*.py"):
        assert re.search(rf"^\| `{file.name}` \| \w.+ \|$", page, re.MULTILINE), file.name


@functools.cache
def entries_of_sensors() -> dict[str, str]:
    """What the page of every sensor says of each."""
    return dict(entry.split("\n", 1) for entry in sensors.page().split("\n## ")[1:])


@pytest.mark.parametrize("name", SENSORS)
def test_the_page_of_every_sensor_tells_each_option_and_each_number(name: str) -> None:
    sensor = SENSORS[name]()
    entries = entries_of_sensors()
    shape = f"has the type {sensor.space.dtype} and the shape `{shape_of(sensor)}`"
    assert f"`{type(sensor).__name__}` {shape}" in entries[name]
    assert f"`{sensor.space.shape}`" in entries[name]
    for field in dataclasses.fields(sensor):  # type: ignore[arg-type]
        default, meaning = json.dumps(getattr(sensor, field.name)), meanings_of(type(sensor))[field.name]
        assert meaning, f"{name}.{field.name}: write what it means behind it"
        row = f"| `{field.name}` | `{default}` | {range_of(type(sensor), field.name)} | {meaning} |"
        assert row in entries[name]
    for place, column in enumerate(sensor.columns):
        assert f"| {place} | {column.name} | {column.unit} |" in entries[name]


@pytest.mark.parametrize(
    ("sensor", "option", "allowed"),
    [
        ("depth", "width", "1 to 1920"),
        ("depth", "moving", "true, false"),
        ("segmentation", "label", '"kind", "instance"'),
        ("nearby_supplies", "range", "above 0, to 200"),
    ],
)
def test_the_range_of_an_option_is_told_in_words(sensor: str, option: str, allowed: str) -> None:
    assert range_of(SENSORS[sensor], option) == allowed


@pytest.mark.parametrize(
    ("sensor", "shape"),
    [
        ("camera", "(height, width, 3)"),
        ("lidar", "(channels, azimuths)"),
        ("visible_agents", "(limit, 13)"),
        ("compass", "(5,)"),
    ],
)
def test_the_shape_of_a_reading_names_the_options_that_set_it(sensor: str, shape: str) -> None:
    assert shape_of(SENSORS[sensor]()) == shape


def test_every_program_of_the_examples_has_a_page_with_its_code() -> None:
    pages = {path: write() for path, write in examples().items()}
    assert "class Altimeter(Sensor)" in pages["examples/altimeter.md"]
    assert "class Summit(Track)" in pages["examples/hills/wildscav_hills/summit.md"]
    assert not any("init" in path for path in pages)


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
    assert "| `metrics` | table of [Summary](#summary) |" in entries["SuiteRow"]
    assert "| `null` for a robot. |" in entries["LadderRow"]
    assert "| How submissions are validated. |" in entries["SeasonView"]
    assert "| More than 1 where organizers had it played again. |" in entries["MatchView"]


def test_the_reference_of_files_tells_every_field_of_the_results_ratings_and_ledgers() -> None:
    page = output_files.page()
    entries_of = dict(entry.split("\n", 1) for entry in re.split(r"\n##+ ", page)[1:])
    for module in (results, identity, standings, tournament_file, entries):
        for name, kind in vars(module).items():
            is_part = inspect.isclass(kind) and issubclass(kind, FileModel)
            if is_part and kind.__module__ == module.__name__:
                shown = [one for one, field in kind.model_fields.items() if not field.exclude]
                assert all(f"| `{field}` |" in entries_of[name] for field in shown), name
    assert all(file in entries_of for file in output_files.FILES)
    settings = entries_of["Settings of a model"]
    assert all(f"| `{field}` |" in settings for field in output_files.ModelSettings.model_fields)


def test_the_reference_of_metrics_tells_what_each_means() -> None:
    rows = re.findall(r"^\| `(wildscav_\w+)` \| .*? \| (.*) \|$", metrics.page(), re.MULTILINE)
    told = dict(rows)
    assert len(told) == len(rows) > 30
    assert all(told.values())
    assert "| `wildscav_season_tables_ended_total` | `outcome` |" in metrics.page()
    for name in ("steps_total", "node_used", "server_matches_open", "season_requests_total", "season_tables"):
        assert f"wildscav_{name}" in told


def test_the_reference_of_tools_tells_every_tool_argument_and_reason() -> None:
    page = tools.page()
    entries_of = dict(entry.split("\n", 1) for entry in re.split(r"\n##+ ", page)[1:])
    for tool in all_tools():
        arguments = set(tool.input_schema.get("properties", {})) - {"thought", "seat"}
        assert all(f"| `{one}` |" in entries_of[tool.name] for one in arguments), tool.name
    assert all(f"| `{reason}` |" in entries_of["Why a tool ends"] for reason in Reason)


def test_the_reference_of_the_sdk_tells_every_ending_and_setting_of_a_model() -> None:
    page = sdk.page()
    assert all(f"| `{ending}` |" in page for ending in Ending)
    assert all(f"| `{field.name}` |" in page for field in fields(ModelSettings))


def test_the_reference_of_the_sdk_does_not_publish_the_environment_it_was_built_in() -> None:
    page = sdk.page()
    assert "in_environment" in page
    assert "environ(" not in page


def test_a_comment_becomes_paragraphs_and_what_is_set_in_stays_as_it_is() -> None:
    comment = " One\n two.\n\n   client    server\n   Join ---> \n\n Three.\n"
    assert protocol.prose(comment) == "One\ntwo.\n\n```text\n  client    server\n  Join --->\n```\n\nThree.\n"


def test_all_that_an_agent_may_import_is_on_it() -> None:
    assert set(sdk.MODULES["wildscav"]) == set(wildscav.__all__) - {"__version__"}
    assert set(sdk.MODULES["wildscav.policy"]) == set(wildscav.policy.__all__)


def test_every_field_has_a_meaning() -> None:
    described = 0
    for module, names in sdk.MODULES.items():
        for name in names:
            thing = getattr(importlib.import_module(module), name)
            for field in sdk.fields_of(thing) if inspect.isclass(thing) else ():
                assert field.meaning, f"{name}.{field.name}: write what it means behind it"
                described += 1
    assert described > 60


@pytest.mark.parametrize(
    ("schema", "told"),
    [
        ({"type": "number", "exclusiveMinimum": 0, "maximum": 3600.0}, "number above 0, to 3,600"),
        ({"type": "integer", "minimum": 1, "maximum": 8}, "integer from 1 to 8"),
        ({"type": "integer", "minimum": 0}, "integer from 0"),
        ({"type": "object", "additionalProperties": {"$ref": "#/x/Summary"}}, "table of [Summary](#summary)"),
        ({"anyOf": [{"enum": ["words", "keys"]}, {"type": "null"}]}, "`words`, `keys` or null"),
    ],
)
def test_what_a_schema_allows_is_told_in_words(schema: dict[str, Any], told: str) -> None:
    assert type_of(schema) == told


def test_a_field_has_the_meaning_beside_it_or_above_it_and_no_heading_of_several() -> None:
    lines = ["# Seats:", "a: int = 1", "b: int = (", "    2  # m", ")", "# of both", "# kinds", "c: int = 3"]
    places = [(2, 2), (3, 5), (8, 8)]
    assert [meaning_of(lines, *place) for place in places] == ["", "m", "of both kinds"]


@pytest.mark.parametrize("kind", [EnvConfig, MapConfig, Country, Placement])
def test_every_field_of_a_map_and_of_an_environment_has_a_meaning(kind: type) -> None:
    assert [field.name for field in sdk.fields_of(kind) if not field.meaning] == []


def test_make_builds_strictly_and_does_not_silence_the_warnings_that_are_counted() -> None:
    # With --quiet, MkDocs counts no warnings, and --strict lets all of them pass.
    done = subprocess.run(["make", "-n", "docs"], cwd=ROOT, capture_output=True, text=True)
    (line,) = [line for line in done.stdout.splitlines() if "mkdocs build" in line]
    assert "--strict" in line
    assert not {"--quiet", "-q"} & set(line.split())
