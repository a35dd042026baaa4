"""The version is the same wherever it is written."""

import tomllib
from pathlib import Path

import wildscav

PROJECT = Path(__file__).parents[3] / "pyproject.toml"


def test_the_package_has_the_version_of_the_project() -> None:
    assert wildscav.__version__ == tomllib.loads(PROJECT.read_text("utf-8"))["project"]["version"]
