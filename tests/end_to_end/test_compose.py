"""docker/compose.yaml names what there is: targets, commands, options, variables, volumes and networks.

The containers themselves need images from other hosts, so they are not started here.
"""

import re
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

from wildscav.cli import main
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.initial_files import make_season_folder

ROOT = Path(__file__).parents[2]
FILE = ROOT / "docker" / "compose.yaml"
PASSWORD = "0f" * 32


def substituted(value: str) -> str:
    """Return a text with its variables: the password is set, the others have their defaults."""
    return re.sub(
        r"\$\{(\w+):-([^}]*)\}",
        lambda found: PASSWORD if found[1] == "WILDSCAV_DATABASE_PASSWORD" else found[2],
        value,
    )


COMPOSE: dict[str, Any] = yaml.safe_load(substituted(FILE.read_text("utf-8")))
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]


@pytest.mark.parametrize("name", SERVICES)
def test_what_a_service_refers_to_is_there(name: str) -> None:
    service = SERVICES[name]
    if "build" in service:
        dockerfile = (FILE.parent / service["build"]["context"] / service["build"]["dockerfile"]).resolve()
        targets = re.findall(r"^FROM \S+ AS (\S+)$", dockerfile.read_text("utf-8"), re.MULTILINE)
        assert service["build"]["target"] in targets
    assert set(service.get("networks", ())) <= set(COMPOSE["networks"])
    assert set(service.get("secrets", ())) <= set(COMPOSE["secrets"])
    for volume in service.get("volumes", ()):
        source = volume.partition(":")[0]
        is_file = source.startswith("./") and (FILE.parent / source).is_file()
        assert is_file or source.startswith("../") or source in COMPOSE["volumes"]


@pytest.mark.parametrize("name", ["web", "conductor"])
def test_the_commands_are_ones_that_wildscav_has(name: str) -> None:
    first, second, folder, *options = SERVICES[name]["command"]
    command = typer.main.get_command(main.app).get_command(None, first).get_command(None, second)  # type: ignore[attr-defined, union-attr]
    context = command.make_context("serve", [folder, *options])
    assert context.params["web"] is (name == "web")
    assert context.params["conductor"] is (name == "conductor")


def test_both_find_the_database_of_the_season(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = {
        key: value for name in ("web", "conductor") for key, value in SERVICES[name]["environment"].items()
    }
    assert SERVICES["web"]["environment"] == SERVICES["conductor"]["environment"]
    for key, value in made.items():
        monkeypatch.setenv(key, value)
    make_season_folder(tmp_path / "spring", None, None, 30)
    database = Season.open(tmp_path / "spring").database()
    database.close()

    given = SERVICES["database"]["environment"]
    assert (database.url.host, database.url.username) == ("database", given["POSTGRES_USER"])
    assert (database.url.database, database.url.password) == (
        given["POSTGRES_DB"],
        given["POSTGRES_PASSWORD"],
    )
    assert PASSWORD not in str(database)


def test_nothing_outside_reaches_the_database() -> None:
    assert SERVICES["database"]["networks"] == ["season"]
    assert COMPOSE["networks"]["season"] == {"internal": True}
    assert "ports" not in SERVICES["database"]
    assert SERVICES["web"]["ports"] == ["127.0.0.1:8000:8000"]


def test_the_web_site_does_not_share_compiled_code_with_what_has_privileges() -> None:
    caches = {
        name: {volume for volume in SERVICES[name]["volumes"] if "cache" in volume}
        for name in SERVICES
        if name != "database"
    }
    assert caches["web"].isdisjoint(caches["conductor"])
    assert not SERVICES["web"].get("privileged")
    assert SERVICES["web"]["cap_drop"] == ["ALL"]
