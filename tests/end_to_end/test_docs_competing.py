"""What the pages of competitors say is true: both tutorials lead from nothing to the final boards."""

import json
import re
import shlex
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import tomli_w
from pydantic import BaseModel
from tests.commands import run_command
from tests.end_to_end.pages import blocks, json_documents
from tests.leaderboard.agents import write_agent
from tests.leaderboard.competing.season_site import Competitor, Site, competitor, season_site
from tests.leaderboard.seasons_made import make_season
from tests.ports import free_ports

from wildscav_leaderboard.api.documents import (
    AccountView,
    MatchView,
    NewTeamView,
    QuotaView,
    SeatView,
    SubmissionView,
    TeamView,
)
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.initial_files import make_season_folder
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.submissions.states import STATES

__all__ = ["competitor"]

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "competing.md"
TUTORIAL = ROOT / "docs" / "tutorial-competitor.md"
OF_ORGANIZERS = ROOT / "docs" / "tutorial-organizer.md"
TEXT = PAGE.read_text("utf-8")
WILDSCAV = str(Path(sys.executable).parent / "wildscav")
PATIENCE = 1200  # looks at a season that plays
SHORTER = {"play": ["--time-limit", "5", "--size", "60"], "evaluate": ["--suite", "spring/tiny.toml"]}


def lines(block: str) -> list[list[str]]:
    """The commands of a block, as words."""
    found = [shlex.split(line, comments=True) for line in block.splitlines()]
    return [words for words in found if words[:1] == ["wildscav"]]


def test_the_states_and_the_variables_told_are_those_that_there_are() -> None:
    rows = re.findall(r"^\| `(\w+)` \|", TEXT, re.MULTILINE)
    assert [row for row in rows if row.islower()] == list(STATES)
    package = ROOT / "leaderboard" / "wildscav_leaderboard"
    code = "".join(path.read_text("utf-8") for path in package.rglob("*.py"))
    assert all(f'"{row}"' in code for row in rows if row.isupper())


def names(document: object) -> set[str]:
    """Every field of a document."""
    if isinstance(document, dict):
        return set(document).union(*map(names, document.values()))
    if isinstance(document, list):
        return set().union(*map(names, document))
    return set()


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    with season_site(tmp_path_factory.mktemp("site")) as one:
        yield one


def test_the_documents_have_the_fields_that_the_help_of_their_commands_tells(
    competitor: Competitor,
) -> None:
    def shown(command: str, *arguments: object, told: str = "") -> Any:
        done = competitor.run(*command.split(), *arguments, "--json")
        assert done.returncode == 0, done.stderr
        document = json.loads(done.stdout)
        assert json_documents()[told or command] - {"agent", "platform"} <= names(document), command
        return document

    shown("login", competitor.site.url, "--token", competitor.site.token("ada"))
    key = shown("team create", "ants")["key"]
    shown("team leave")
    shown("team join", key)
    shown("team show")
    shown("team key")
    write_agent(competitor.folder, "walker")
    number = shown("submit", "walker")["submission"]["id"]
    shown("team submissions", number)
    match = competitor.site.played(number, 0)
    shown("team matches", number)
    of_match = json.loads(competitor.run("team", "logs", "--match", match, "--json").stdout)
    assert names(of_match) == json_documents()["team logs"] - {"submission"}
    shown("leaderboard --season", "latest", told="leaderboard of a season")
    shown("team submissions cancel", number, told="team submissions with an act")
    shown("login --logout", told="login with --logout")


@pytest.mark.parametrize(
    ("command", "documents"),
    [
        ("login", [AccountView]),
        ("team create", [NewTeamView, TeamView]),
        ("team show", [QuotaView]),
        ("team matches", [MatchView, SeatView]),
        ("submit", [SubmissionView]),
    ],
)
def test_the_help_tells_every_field_of_its_documents(command: str, documents: list[type[BaseModel]]) -> None:
    there = {field for one in documents for field in one.model_fields}
    assert there - json_documents()[command] == set()


def commands(page: Path) -> list[list[str]]:
    """The commands of a page, as words."""
    return [words for block in blocks(page, "console") for words in lines(block)]


def test_the_tutorial_gives_the_commands_with_which_the_page_of_competitors_begins() -> None:
    assert all(words in commands(TUTORIAL) for words in lines(blocks(PAGE, "console")[0]))


def improve(agent: Path) -> None:
    """Change the agent that a newcomer begins with as the tutorial says."""
    imports, aiming = blocks(TUTORIAL, "python")
    code, changes = re.subn(r" {8}if enemy is not None:\n( {12}.*\n)+", aiming, agent.read_text("utf-8"))
    assert changes == 1
    agent.write_text(code.replace("import random\n", f"import random\n{imports}"), "utf-8")


def run(folder: Path, *words: str) -> str:
    """What a command prints."""
    done = run_command(*words, cwd=folder)
    assert done.returncode == 0, (words, done.stdout, done.stderr)
    return done.stdout


def until(folder: Path, found: Callable[[Any], Any], *command: str) -> Any:
    """What is found in the document of a command, once it is there."""
    for _ in range(PATIENCE):
        done = run_command(*command, "--json", cwd=folder)
        if done.returncode == 0 and (seen := found(json.loads(done.stdout))):
            return seen
        time.sleep(0.5)
    raise AssertionError((command, done.stdout, done.stderr))


class Person(NamedTuple):
    """Somebody who competes in the season of the organizers' tutorial."""

    name: str
    folder: Path
    url: str
    invitation: str

    def run(self, *words: str) -> str:
        own = [re.sub(r"^https?:.*", self.url, word) for word in words]
        own = [word.replace("invite_KEY", self.invitation) for word in own]
        # A person would be asked for the name.
        return run(self.folder, *own, *(["--name", self.name] if own[0] == "login" else []))


def compete(person: Person) -> int:
    """Follow the competitors' tutorial, and return the number of a match of the submission."""
    match, folder = 0, person.folder
    for words in commands(TUTORIAL):
        own = [{"12": "2", "345": str(match)}.get(word, word) for word in words[1:]]
        own += SHORTER.get(own[0], [])
        if own[0] == "watch":  # until Ctrl-C
            continue
        person.run(*own)
        if own[0] == "evaluate":
            improve(folder / "my-agent" / "agent.py")
            assert "since last time" in person.run(*own)
        elif own[0] == "leaderboard":
            until(folder, has_team, "leaderboard", "--season", "latest")
            match = until(folder, seen_match, "team", "matches", "2", "--track", "battle")
    return match


@pytest.mark.slow
def test_the_way_from_an_empty_folder_to_the_final_boards(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The organizers' tutorial with its own submission, and between its steps the competitors' tutorial."""
    port = free_ports()
    url = f"http://127.0.0.1:{port}"
    monkeypatch.setenv("WILDSCAV_CONFIG_DIR", str(tmp_path / "settings"))
    monkeypatch.setenv("WILDSCAV_PASSWORD", "a long password")
    # One match is over before a second worker has started.
    monkeypatch.setattr("wildscav_evaluator.executors.local.cores", lambda: 1)
    to_make, to_check, to_open, to_submit, to_announce, to_end, to_audit = map(
        lines, blocks(OF_ORGANIZERS, "console")
    )
    for words in to_make[1:]:  # what the doctor says depends on the machine
        run(tmp_path, *words[1:])
    small = make_season(tmp_path / "small", "matches = 2\nwaiting = 2", current=True).folder
    (tmp_path / "spring" / "tiny.toml").write_text((small / "tiny.toml").read_text())
    settings = (small / "season.toml").read_text().replace('"open"', '"invited"')
    (tmp_path / "spring" / "season.toml").write_text(settings)
    (checking,), (organizer, invite, serve) = to_check, to_open
    run(tmp_path, *checking[1:])
    run(tmp_path, *organizer[1:])
    key = run(tmp_path, *invite[1:]).strip()
    server = subprocess.Popen([WILDSCAV, *serve[1:], "--port", str(port)], cwd=tmp_path)
    try:
        until(tmp_path, bool, "leaderboard", "--season", url)
        for words in to_submit:
            Person("ben", tmp_path, url, key).run(*words[1:])
        match = compete(Person("ada", tmp_path, url, key))
        run(tmp_path, "replay", str(match), "--no-images")
        run(tmp_path, "verify", f"match-{match}.wsr")
        for words in [*to_announce, *to_end]:
            run(tmp_path, *words[1:], *(["--yes"] if "--now" in words else []))
    finally:
        server.terminate()
        server.wait(60)
    assert (tmp_path / f"match-{match}.rrd").is_file()
    (verify,) = to_audit
    assert "everything that was checked is right" in run(tmp_path, *verify[1:])


def test_the_settings_of_the_tutorial_are_settings(tmp_path: Path) -> None:
    make_season_folder(tmp_path / "spring", None, None, days=30)
    (changes,) = blocks(OF_ORGANIZERS, "toml")
    path = tmp_path / "spring" / SETTINGS_FILE
    path.write_text(tomli_w.dumps(tomllib.loads(path.read_text()) | tomllib.loads(changes)))
    assert Season.open(path.parent).settings.execution.sandbox == "bubblewrap"


def has_team(document: Any) -> bool:
    """Whether the team of the page has a rank on the board of navigation."""
    rows = [row for board in document["boards"] if board["track"] == "navigation" for row in board["rows"]]
    return any(row["team_title"] == "The Night Owls" and row["rank"] for row in rows)


def seen_match(document: Any) -> int | None:
    """The number of a match that is over and may be seen."""
    over = (one["id"] for one in document["matches"] if one["state"] == "finished" and not one["hidden"])
    return next(over, None)
