"""What the pages of organizing say is so: every command runs as it stands, and every setting is one."""

import asyncio
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import typer
from tests.end_to_end.pages import blocks
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from wildscav.cli import main
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_leaderboard.seasons.folder import PUBLISHED, Season
from wildscav_leaderboard.seasons.settings import Execution, Play, Quotas, SeasonSettings, Web

PAGE = Path(__file__).parents[2] / "docs" / "organizing.md"
TUTORIAL = PAGE.with_name("tutorial-organizer.md")
TEXT = PAGE.read_text("utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", TEXT, re.DOTALL)
LINES = [line for kind, block in BLOCKS if kind == "console" for line in block.splitlines()]
*BEGINNING, END, _ = (block.splitlines() for block in blocks(TUTORIAL, "console"))
OF_THE_TUTORIAL = [line for block in BEGINNING for line in block if line.startswith("wildscav season")]
INLINE = re.findall(r"`(wildscav season [^`]+)`", TEXT)
ENDLESS = ("serve", "demo")
# These need a submission, a team or an account.
OF_SOMEBODY = (
    "rerun",
    "rejudge",
    "disqualify",
    "requalify",
    "reactivate",
    "disable",
    "enable",
    "hide",
    "unhide",
)
AT_THE_END = {"finalize": ("--now", "--yes")}  # or it would wait for the date


def test_the_file_for_nginx_lets_the_largest_archive_pass_and_says_who_asks() -> None:
    text = (PAGE.parents[1] / "docker" / "nginx.conf").read_text("utf-8")
    (body,) = re.findall(r"client_max_body_size (\d+)m;", text)
    (archive,) = (one.le for one in Quotas.model_fields["archive"].metadata if hasattr(one, "le"))
    assert int(body) > archive  # the rest of the form takes room, too

    values = {"$host": b"season.example", "$scheme": b"https", "$remote_addr": b"203.0.113.9"}
    values |= {"$http_upgrade": b"websocket", "$connection_upgrade": b"upgrade"}
    set_headers = re.findall(r"proxy_set_header (\S+) (\S+);", text)
    headers = {name.lower().encode(): values[value] for name, value in set_headers}
    assert (headers[b"host"], headers[b"upgrade"]) == (b"season.example", b"websocket")
    assert headers[b"connection"] == b"upgrade"
    seen: dict[str, Any] = {}

    async def season(scope: Any, *_: Any) -> None:
        seen.update(scope)

    proxied = {"type": "http", "scheme": "http", "client": ("127.0.0.1", 9), "headers": list(headers.items())}
    asyncio.run(ProxyHeadersMiddleware(season, "127.0.0.1")(proxied, None, None))  # type: ignore[arg-type]
    assert (seen["scheme"], seen["client"][0]) == ("https", "203.0.113.9")


def words(line: str) -> list[str]:
    """Return the words of a command, as a shell splits it."""
    return [first or second for first, second in re.findall(r'"([^"]*)"|(\S+)', line)]


def season_commands() -> set[str]:
    season = typer.main.get_command(main.app).get_command(None, "season")  # type: ignore[attr-defined]
    return set(season.list_commands(None))


def test_every_command_of_a_season_is_on_a_page() -> None:
    told = {words(line)[2] for line in (*OF_THE_TUTORIAL, *LINES, *INLINE, *END) if len(words(line)) > 2}
    assert told == season_commands()


def test_the_commands_run_in_their_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for line in (*OF_THE_TUTORIAL, *LINES, *END):
        name = words(line)[2]
        if name in (*ENDLESS, *OF_SOMEBODY):
            continue
        monkeypatch.setattr("sys.argv", [*words(line), *AT_THE_END.get(name, ())])
        with pytest.raises(SystemExit) as ended:
            main.main()
        assert ended.value.code == 0, line
    assert (tmp_path / "spring" / PUBLISHED / "season.json").is_file()
    assert Season.open(tmp_path / "spring-again").settings == Season.open(tmp_path / "spring").settings


@pytest.mark.parametrize("block", [block for kind, block in BLOCKS if kind == "toml"])
def test_the_settings_on_the_page_are_settings(block: str) -> None:
    for section, values in tomllib.loads(block).items():
        kind = {"web": Web, "execution": Execution, "play": Play, "model": ModelSettings}[section]
        assert kind.model_validate(values)
    assert {"freezes", "closes", "registration"} <= set(SeasonSettings.model_fields)
