"""docs/legacy.md names what there is."""

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from tests.platform.legacy.helpers.original import install, run
from tests.ports import free_ports

import wildscav

PAGE = (Path(__file__).parents[3] / "docs" / "legacy.md").read_text("utf-8")


def names_of(kind: Any) -> set[str]:
    """Return the names of the fields of a dataclass or a named tuple."""
    return set(getattr(kind, "_fields", ())) or {field.name for field in fields(kind)}


@pytest.mark.parametrize("name", ["Action", "MatchInfo", "Observation"])
def test_new_names_are_those_of_the_sdk(name: str) -> None:
    known = names_of(getattr(wildscav, name)) | {"depth"}
    table = PAGE.partition("| `inspirai_fps` |")[2]
    named = set(re.findall(rf"`{name}\.(\w+)`", table))
    assert len(named) > 2
    assert named <= known


def test_scripts_of_the_page_use_nothing_that_a_version_does_not_have() -> None:
    scripts = "".join(re.findall(r"```(?:python|text)\n(.*?)```", PAGE, re.DOTALL))
    assert "game.get_state()" in scripts
    for only_in_the_older in ("outdoor_locations", "indoor_locations", "get_frame_count"):
        assert f"game.{only_in_the_older}" not in scripts
    assert "get_valid_locations" not in scripts, "only in the newer"


@pytest.mark.slow
def test_the_script_of_the_page_runs(tmp_path: Path) -> None:
    script = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[0]
    install(tmp_path / "wilderness", 1)
    script = script.replace("50051", str(free_ports()))
    said = run(["-c", script], tmp_path).splitlines()
    assert "500 (22, 38)" in said
