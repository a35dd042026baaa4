"""What commands print with: no untrusted text steers a terminal, breaks a table or is lost."""

import io
import json
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import example, given
from rich.console import Console
from rich.table import Table
from rich.text import Text
from tests.platform.helpers.plain_text import ANYTHING, HOSTILE, is_plain

from wildscav.terminal.console import PlainConsole, ascii_json, print_json, printable
from wildscav_server.monitoring.logs import LogFormat, open_log


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("Ünïcödé, 日本 [red]", "Ünïcödé, 日本 [red]"),
        ("\x1b[2J", "\\x1b[2J"),
        ("a\nb", "a\\nb"),
        ("\u202egnp.exe", "\\u202egnp.exe"),
        ("\ud800", "\\ud800"),
        ("\x9b2J", "\\x9b2J"),
    ],
)
def test_what_is_no_plain_character_stands_as_its_escape(text: str, shown: str) -> None:
    assert printable(text) == shown


@given(ANYTHING)
@example(HOSTILE)
def test_a_console_shows_any_text_and_only_as_text(text: str) -> None:
    console = PlainConsole(file=io.StringIO(), width=60, color_system=None)
    table = Table(text, title=text, caption=text)
    table.add_row(text)
    table.add_row(Text(text, "red"))

    console.print(table)
    console.print(text, Text(text), Text.assemble((text, "bold")), soft_wrap=True)

    assert isinstance(console.file, io.StringIO)
    assert is_plain(console.file.getvalue())
    if text.isprintable() and text.strip():
        assert text in console.file.getvalue()


def test_a_terminal_gets_no_control_sequences_but_our_own() -> None:
    shown = []
    for make in (Console, PlainConsole):
        console = make(file=io.StringIO(), width=60, force_terminal=True)
        with console.status(Text("trying \x1b[5m")):
            console.print(Text("\x1b[2Jgone\u202e", "red"))
        assert isinstance(console.file, io.StringIO)
        shown.append(console.file.getvalue())
    assert ["\x1b[2J" in one or "\x1b[5m" in one or "\u202e" in one for one in shown] == [True, False]
    assert "\x1b[31m\\x1b[2Jgone\\u202e" in shown[1]


@given(ANYTHING)
@example(HOSTILE)
def test_json_is_plain_ascii_and_says_the_same(text: str) -> None:
    document = ascii_json(json.dumps({text: [text]}, ensure_ascii=False))
    assert document.isascii()
    assert is_plain(document)
    assert json.loads(document) == {text: [text]} or "\ud800" <= max(text) <= "\udfff"


@pytest.mark.parametrize("form", ["json", "text"])
@given(text=ANYTHING)
@example(text=HOSTILE)
def test_log_lines_are_plain(form: LogFormat, text: str) -> None:
    lines = io.StringIO()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.stderr", lines)
        open_log(form, who=text).warning("match_ends", detail=text, seats=[{"detail": text}])
    assert is_plain(lines.getvalue())
    assert lines.getvalue().count("\n") == 1


def test_text_stays_on_one_line_however_narrow_the_terminal_is() -> None:
    console = PlainConsole(file=io.StringIO(), width=10)
    line = "the address is https://season.example.org"

    console.print(line)
    console.print(Text(line, "dim"))

    assert isinstance(console.file, io.StringIO)
    assert console.file.getvalue() == f"{line}\n{line}\n"


def test_a_json_document_has_times_and_paths_as_text(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"at": datetime(2030, 6, 1, tzinfo=UTC), "folder": Path("out")})
    assert json.loads(capsys.readouterr().out) == {"at": "2030-06-01 00:00:00+00:00", "folder": "out"}
