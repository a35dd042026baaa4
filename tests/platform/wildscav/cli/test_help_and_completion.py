"""The command line as people know it from other programs: help, completion, suggestions, tables that fit."""

import io
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer
from tests.commands import run_command
from typer.testing import CliRunner

from wildscav.cli import main
from wildscav.cli.main import Commands
from wildscav.terminal.console import PlainConsole
from wildscav.terminal.suggestions import did_you_mean
from wildscav.terminal.tables import FittingTable

WILDSCAV = str(Path(sys.executable).parent / "wildscav")


def everything(command: object, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Every command, as it is typed."""
    yield path
    for name in command.list_commands(None) if hasattr(command, "list_commands") else ():
        yield from everything(command.get_command(None, name), (*path, name))  # type: ignore[attr-defined]


ROOT = typer.main.get_command(main.app)
EVERYTHING = sorted(set(everything(ROOT)))


def test_every_command_is_in_a_group_of_the_help_and_has_a_line_there() -> None:
    assert isinstance(ROOT, Commands)
    for name in ROOT.list_commands(None):
        command = ROOT.get_command(None, name)
        assert command.rich_help_panel in main.PANELS, name
        assert command.name == name
        assert len(command.get_short_help_str()) > 20, name


@pytest.mark.parametrize("arguments", EVERYTHING, ids=" ".join)
def test_every_command_knows_h(arguments: tuple[str, ...]) -> None:
    done = CliRunner().invoke(main.app, [*arguments, "-h"], prog_name="wildscav")
    assert done.exit_code == 0, done.output
    assert f"Usage: {' '.join(['wildscav', *arguments])}" in done.output
    if arguments:
        assert "completion" not in done.output, "completion belongs to the main command"


def test_the_help_of_a_command_is_wrapped_by_the_terminal_alone() -> None:
    for name, *below in filter(None, EVERYTHING):
        command = ROOT.get_command(None, name)  # type: ignore[attr-defined]
        for each in below:
            command = command.get_command(None, each)
        assert all("\n" not in paragraph for paragraph in command.help.split("\n\n")), (name, *below)


def test_a_command_whose_extra_is_missing_says_which_one() -> None:
    def broken() -> None:
        raise ModuleNotFoundError("No module named 'scipy'", name="scipy")

    missing = ModuleNotFoundError("No module named 'scipy'", name="scipy")
    assert "pip install 'wildscav[maps]'" in str(main._remedy(missing))
    unix = ModuleNotFoundError("No module named 'fcntl'", name="fcntl")
    assert "it needs Linux, or another Unix" in str(main._remedy(unix))
    # As if a command of the evaluator had imported it.
    code = compile("def call(f): f()", "evaluate.py", "exec")
    for package, extra in (("wildscav_evaluator.cli", "evaluator"), ("wildscav_leaderboard", "leaderboard")):
        names: dict[str, object] = {"__name__": package}
        exec(code, names)  # noqa: S102
        with pytest.raises(ModuleNotFoundError) as caught:
            names["call"](broken)  # type: ignore[operator]
        assert f"pip install 'wildscav[{extra}]'" in str(main._remedy(caught.value))
    shown = main._unavailable("play", missing).__doc__
    assert shown is not None
    assert r"wildscav\[maps]" in shown, "help reads markup, which would swallow the brackets"


def complete(line: str) -> set[str]:
    words = line.split(" ")
    asked = {"_WILDSCAV_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)}
    return set(run_command(**asked).stdout.split())


def test_a_shell_completes_commands_options_and_values() -> None:
    assert complete("wildscav ev") == {"evaluate"}
    assert complete("wildscav season secret o") == {"open"}
    assert {"--suite", "--sandbox"} <= complete("wildscav evaluate --s")
    assert complete("wildscav evaluate --sandbox b") == {"bubblewrap"}


def test_zsh_completes_too() -> None:
    asked = {"_WILDSCAV_COMPLETE": "complete_zsh", "_TYPER_COMPLETE_ARGS": "wildscav map look --sen"}
    said = run_command(**asked).stdout
    assert said.startswith("_arguments ")
    assert '"--sensor":' in said


def test_completion_is_installed_by_the_main_command(tmp_path: Path) -> None:
    done = run_command("--show-completion", HOME=str(tmp_path), SHELL="/bin/bash")
    if done.returncode:  # the shell is found out from the process that called
        done = run_command(_WILDSCAV_COMPLETE="source_bash")
    assert "_WILDSCAV_COMPLETE=complete_" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["evalaute"], "No such command 'evalaute' (did you mean 'evaluate'?)"),
        (["season", "secret", "ope"], "Did you mean 'open'?"),
        (["verify", "--jsno", "x"], "--json"),
        (["map", "show", "--sead", "3"], "No such option: --sead"),
        (["play", "homng"], "submission homng does not exist (did you mean 'homing'?)"),
        (["play", "homing", "--track", "navigaton"], "(did you mean 'navigation'?)"),
        (["play", "homing", "--replay", "x.mp4"], "--replay is x.mp4: a replay is a Rerun recording"),
        (["init", "new", "--from", "hoving"], "there is no baseline 'hoving' (did you mean 'homing'?)"),
        (["play", "homing", "--sandbox", "bublewrap"], "'oci', 'bubblewrap', 'process'"),
    ],
)
def test_what_is_mistyped_gets_a_suggestion(tmp_path: Path, arguments: list[str], says: str) -> None:
    done = run_command(*arguments, cwd=tmp_path, columns=200)
    assert done.returncode == 2
    assert says in " ".join(done.stderr.split())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("verify", "Missing argument"),
        ("init .", "is not an empty folder"),
        (
            "dataset --id new-v0",
            "there are no episodes: name record files, or an agent that plays with --agent",
        ),
        ("dataset a.wsr --agent homing --id new-v0", "records and --agent are both given"),
        ("dataset a.wsr --seed 0 --id new-v0", "--seed goes only with --agent"),
        ("dataset --agent homing --seat 0 --id new-v0", "--seat goes only with records"),
        ("dataset --agent homing --track batle --id new-v0", "--track is 'batle' (did you mean 'battle'?)"),
    ],
)
def test_what_cannot_be_done_is_said(tmp_path: Path, line: str, says: str) -> None:
    (tmp_path / "a.wsr").touch()
    done = run_command(*line.split(), cwd=tmp_path, columns=200)
    assert done.returncode == 2
    assert says in done.stderr


# One wrong value, or more, for every command. What is in braces is there; nothing else is.
WRONG = [
    "init {file}",
    "init .",
    "init new --name A/B",
    "init new --from-policy {file}",
    "init new --from homing --from-policy {file}",
    "train --track swimming",
    "train --level easy --map 101",
    "baselines --level simple",
    "train --curriculum 5,2",
    "train --curriculum far",
    "train --curriculum 5 --track battle",
    "train --out {file}",
    "train --submission {broken}",
    "dataset --id new-v0",
    "dataset {file} --id new-v0",
    "dataset {file} --seed 3 --id new-v0",
    "dataset {file} --agent homing --id new-v0",
    "dataset --agent homing --track swimming --id new-v0",
    "human --track chess",
    "human --opponents {nothing}",
    "human --records {file}",
    "mcp --out {file}",
    "mcp --http 0.0.0.0:0",
    "mcp --http nonsense",
    "mcp --http 127.0.0.1:0 --site http://[::1",
    "mcp --token-file {file}",
    "play {nothing}",
    "play {file}",
    "play {broken}",
    "play image:",
    "play homing --time-limit nan",
    "play homing --size 41",
    "play homing --logs {file}",
    "check {empty}",
    "check homing --logs {file}",
    "build {broken}",
    "evaluate {nothing}",
    "evaluate homing --suite {file}",
    "evaluate homing --sign {file}",
    "evaluate homing --secret {empty}",
    "evaluate homing --out {file}",
    "evaluate homing homing",
    "evaluate homing --address localhost:1",
    "evaluate homing --executor ray --address localhost",
    "doctor --executor ray --address 127.0.0.1:1",
    "map make",
    "map make --level easy --suite quick",
    "map make --suite quick --track swimming",
    "map make --suite quick --unseen",
    "map make --level easy --address localhost:1",
    "compare homing {empty}",
    "price homing --paces 1,0",
    "price homing --clock paused",
    "evaluate homing --clock running,pace=fast",
    "tournament homing --track battle",
    "tournament homing {empty} --track battle",
    "leaderboard {file}",
    "replay {binary}",
    "replay {binary} --out x.mp4",
    "verify {binary} --agent homing",
    "verify {nothing} --agent homing --logs {file}",
    "verify {binary} {empty}",
    "verify {empty} --agent homing",
    "verify {binary} --track battle",
    "verify {binary}",
    "verify {empty}",
    "verify {file}",
    "season secret new {file}",
    "season secret commitment {file}",
    "season secret open {file} {empty}",
    "verify {empty} --commitment abc",
    "season key new {file}",
    "season key new {nothing}/key",
    "season key public {binary}",
    "serve --listen nonsense",
    "serve --listen 0.0.0.0:0",
    "serve --metrics-port 65535 --workers 2",
    "serve --organizer-token-file {nothing}",
    "serve --listen unix:/dev/null/socket",
    "serve --tls-cert {file} --tls-key {file}",
    "serve --tls-cert {file}",
    "doctor {file}",
    "map info --config {binary}",
    "map show 101 --out {file}",
    "map export 101 --out {file}",
    "map import {file}",
    "map look 101 --position nan,0",
    "leaderboard --season latest",
    "leaderboard --season latest --suite quick",
    "leaderboard 127.0.0.1:1",
    "replay {binary} --video",
    "replay 12",
    "replay 12 --season ftp://there",
    "replay {binary} --season 127.0.0.1:1",
    "watch {binary} --no-browser",
    "login",
    "login {file}/{file}",
    "login 127.0.0.1:1",
    "login 127.0.0.1:1 --invitation key",
    "login --logout",
    "login --logout 127.0.0.1:1",
    "team create ants",
    "team join key",
    "team leave --season 127.0.0.1:1",
    "team show ants",
    "team key --season 127.0.0.1:1",
    "submit {broken}",
    "submit {nothing}",
    "submit homing",
    "team submissions",
    "team submissions --wait",
    "team submissions 1 --season 127.0.0.1:1",
    "team matches 1",
    "team matches 1 --match 2",
    "team logs",
    "team logs 1 --match 2",
    "team logs --match 2",
    "team submissions cancel 1",
    "season demo --folder {broken}",
    "season init {file}",
    "season init new --name A/B",
    "season serve {empty}",
    "season status {nothing}",
    "season invite {empty}",
    "season organizer {empty} anna",
    "season announce {file} welcome",
    "season pause {empty}",
    "season apply {empty}",
    "season rejudge {empty}",
    "season unfreeze {empty}",
    "season requalify {empty} foxes --reason why",
    "season hide {empty} 3 --reason why",
    "season unhide {empty} 3",
    "season reactivate {empty} 3 --reason why",
    "season resume {empty}",
    "season rerun {empty} 1",
    "season disqualify {empty} foxes --reason cheating",
    "season disable {empty} anna --reason cheating",
    "season enable {empty} anna",
    "season password {empty} anna",
    "season freeze {empty}",
    "season finalize {empty}",
    "season export {empty} {nothing}",
    "verify {empty} --download 3",
    "verify http://127.0.0.1:1/",
    "verify ftp://127.0.0.1/",
    "verify http://127.0.0.1:1/ --download few",
    "season backup {empty} backup.tar",
    "season restore {file} new",
    "season restore {nothing} new",
    "season check {empty}",
]


@pytest.fixture
def kit(tmp_path: Path) -> dict[str, str]:
    """Names of what is in a folder, and of what is not."""
    for folder in ("empty", "broken"):
        (tmp_path / folder).mkdir()
    (tmp_path / "file.txt").write_text("A file. ")
    (tmp_path / "binary.bin").write_bytes(bytes(range(256)))
    (tmp_path / "broken" / "submission.toml").write_text("name = = 3")
    return {"file": "file.txt", "binary": "binary.bin"} | {
        name: name for name in ("nothing", "empty", "broken")
    }


@pytest.mark.parametrize("line", WRONG)
def test_what_is_wrong_is_said_without_a_traceback_and_leaves_nothing_behind(
    tmp_path: Path,
    kit: dict[str, str],
    line: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("WILDSCAV_CONFIG_DIR", str(tmp_path / "settings"))  # logged in nowhere
    monkeypatch.setattr("sys.argv", ["wildscav", *line.format(**kit).split()])
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
    with pytest.raises(SystemExit) as ended:
        main.main()
    said = capsys.readouterr().err
    assert ended.value.code in (1, 2)
    assert "Traceback" not in said
    assert said.startswith(("wildscav: ", "Usage: "))
    assert said.startswith("Usage") or said.count("\n") == 1
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before


def test_every_command_is_given_something_wrong() -> None:
    groups = {"", "map", "season", "season key", "season secret", "team"}
    tried = {" ".join(arguments) for arguments in EVERYTHING} - groups
    assert tried == {name for name in tried if any(line.startswith(f"{name} ") for line in WRONG)}


@pytest.mark.parametrize(
    ("word", "question"),
    [
        ("nav", " (did you mean 'navigation'?)"),
        ("batle", " (did you mean 'battle'?)"),
        ("xyzzy", ""),
        ("", ""),
    ],
)
def test_only_what_is_near_is_suggested(word: str, question: str) -> None:
    assert did_you_mean(word, ["navigation", "battle"]) == question


def test_init_quotes_what_it_suggests_and_copies_a_baseline(tmp_path: Path) -> None:
    done = run_command("init", "My Agent", "--from", "homing", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for command in ("play", "check", "evaluate"):
        assert f"  wildscav {command} 'My Agent'  # " in done.stdout
    assert "  wildscav login URL --register --invitation KEY  # " in done.stdout
    assert "  wildscav submit 'My Agent' --wait  # " in done.stdout
    assert 'name = "my-agent"' in (tmp_path / "My Agent" / "submission.toml").read_text()
    assert (tmp_path / "My Agent" / "README.md").is_file()


def test_the_comments_in_a_new_readme_stand_below_each_other(tmp_path: Path) -> None:
    assert run_command("init", "a-rather-long-name", cwd=tmp_path).returncode == 0
    lines = (tmp_path / "a-rather-long-name" / "README.md").read_text().splitlines()
    assert len({line.index(" # ") for line in lines if " # " in line}) == 1


@pytest.mark.parametrize("width", [60, 80, 120])
@pytest.mark.parametrize("columns", [2, 6, 12])
def test_no_column_of_a_table_is_lost(width: int, columns: int) -> None:
    console = PlainConsole(file=io.StringIO(), width=width, color_system=None)
    table = FittingTable("title")
    table.add_column("submission", min_width=12)
    for number in range(columns):
        table.add_column(f"head\n{number}", justify="right", no_wrap=True)
    table.add_row("homing 1.0.0", *(f"figure {number}" for number in range(columns)))
    console.print(table)
    assert isinstance(console.file, io.StringIO)
    shown = console.file.getvalue()
    assert all(len(line) <= width for line in shown.splitlines())
    for number in range(columns):
        assert f"figure {number}" in shown
    assert all(word in shown for word in ("title", "submission", "homing 1.0.0"))
    # Side by side there is one line a row; one below the other, a line a cell.
    needed = 12 + sum(len(f" figure {number}") for number in range(columns))
    assert ("figure 0 figure 1" in " ".join(shown.split())) == (needed <= width)
