"""Names of release 0.1: they still do what they did, and print what they are called now."""

import pytest
import typer
from tests.commands import run_command

from wildscav.cli import main
from wildscav.cli.old_names import COMMANDS, with_new_names


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("rescore out --jobs 2 --key=ab", "verify out --workers 2 --key=ab"),
        ("audit URL --records 3 --replay none", "verify URL --download 3 --resimulate none"),
        ("replay-agent --seat 1 m.wsr mine --logs l", "verify --seat 1 m.wsr --agent mine --logs l"),
        ("secret check out abc", "verify out --commitment abc"),
        ("secret open FILE out", "season secret open FILE out"),
        ("video m.wsr --follow -o m.gif", "replay --video m.wsr --view=behind -o m.gif"),
        ("replay m.wsr --follow 2 --output=m.rrd", "replay m.wsr --seat 2 --out=m.rrd"),
        ("look 101 --output x.png", "map look 101 --out x.png"),
        ("cancel 3", "team submissions cancel 3"),
        ("logout", "login --logout"),
        ("play homing --map 3", "play homing --map-seed 3"),
        ("train --at-once 2", "train --workers 2"),
        ("season demo --no-open", "season demo --no-browser"),
        ("evaluate homing --jobs 1", "evaluate homing --workers 1"),
        ("leaderboard --season --json", "leaderboard --season latest --json"),
        ("leaderboard --track battle http://a --season", "leaderboard --season http://a --track battle"),
        ("leaderboard --season --track battle http://a", "leaderboard --season http://a --track battle"),
        ("leaderboard --track battle --season", "leaderboard --season latest --track battle"),
        ("leaderboard --season URL --json", "leaderboard --season URL --json"),
        ("human --map 3", "human --map 3"),  # the number of a map, as before
        ("team create --title --output", "team create --title --output"),  # no option of this command
        ("nonsense --jobs 1", "nonsense --jobs 1"),
    ],
)
def test_an_old_line_is_the_new_one(old: str, new: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert with_new_names(old.split(), typer.main.get_command(main.app), None) == new.split()
    assert ("is called" in capsys.readouterr().err) == (old != new)


def test_every_new_name_is_a_command() -> None:
    root = typer.main.get_command(main.app)
    for new in COMMANDS.values():
        command = root
        for word in (word for word in new if not word.startswith("-") and word != "cancel"):
            command = command.get_command(None, word)  # type: ignore[attr-defined]
            assert command is not None, new


def test_an_old_command_runs_and_prints_its_new_name() -> None:
    done = run_command("look", "-5")
    renamed, error = done.stderr.splitlines()
    assert renamed.startswith("wildscav: `wildscav look` is called `wildscav map look` now")
    assert error == "wildscav: ID is -5, must be 1 to 999"
