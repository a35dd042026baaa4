"""What agents say and draw: printed by the SDK, and read from logs that may hold anything."""

import json
from typing import Any

import pytest

import wildscav
from wildscav.errors import AgentError
from wildscav.notes import LONGEST_TEXT, MOST_A_STEP, PREFIX, Note, begin_step, note_line, read_notes


def test_notes_of_the_functions_are_read_from_the_log(capsys: pytest.CaptureFixture[str]) -> None:
    begin_step(12)
    wildscav.say("I hide.", public=True)
    wildscav.mark("goal", (3.0, 0.5, -7.25))
    wildscav.mark("goal")
    wildscav.plot("fear", 0.3)
    begin_step(None)
    wildscav.say("nobody hears this")

    assert [*read_notes(capsys.readouterr().out.splitlines(keepends=True), 2)] == [
        Note(2, 12, text="I hide.", public=True),
        Note(2, 12, name="goal", points=((3.0, 0.5, -7.25),)),
        Note(2, 12, name="goal"),
        Note(2, 12, name="fear", value=0.3),
    ]


def test_a_step_has_eight_notes_at_most(capsys: pytest.CaptureFixture[str]) -> None:
    begin_step(0)
    for number in range(20):
        wildscav.say(str(number))
    begin_step(None)
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == MOST_A_STEP
    assert len([*read_notes(printed * 3, 0)]) == MOST_A_STEP


@pytest.mark.parametrize(
    ("call", "why"),
    [
        (lambda: wildscav.say(3), "must be a string"),  # type: ignore[arg-type]
        (lambda: wildscav.mark("", (0.0, 0.0, 0.0)), "1 to 40 characters"),
        (lambda: wildscav.mark("way", (0.0, 1.0)), "x, y, z"),  # type: ignore[arg-type]
        (lambda: wildscav.mark("way", (float("nan"), 0.0, 0.0)), "x, y, z"),
        (lambda: wildscav.mark("way", *[(0.0, 0.0, 0.0)] * 101), "at most 100"),
        (lambda: wildscav.plot("fear", float("inf")), "within ±100,000"),
    ],
)
def test_what_cannot_be_shown_is_refused(call: Any, why: str) -> None:
    with pytest.raises(AgentError, match=why):
        call()


@pytest.mark.parametrize(
    "content",
    [
        *("", "{", "[]", "null", "[" * 9000, '{"step": 1}', '{"say": "when?"}'),
        *({"step": -1, "say": "a"}, {"step": True, "say": "a"}, {"step": 2**31, "say": "a"}),
        *({"step": 1, "say": 5}, {"step": 1, "say": "a" * 30_000}),
        *({"step": 1, "mark": "m", "at": [[1, 2]]}, {"step": 1, "mark": "m", "at": [[1, 2, 1e9]]}),
        *({"step": 1, "mark": "m", "at": [[0, 0, True]]}, {"step": 1, "mark": "m" * 41, "at": []}),
        *('{"step": 1, "plot": "p", "value": NaN}', '{"step": 1, "plot": "p", "value": 1e999}'),
        f'{{"step": {"9" * 5000}, "say": "a"}}',
    ],
)
def test_a_line_that_is_no_note_is_skipped(content: object) -> None:
    text = content if isinstance(content, str) else json.dumps(content)
    assert [*read_notes([f"{PREFIX}{text}\n", note_line(1, say="b")], 0)] == [Note(0, 1, text="b")]


def test_notes_go_forward_in_time() -> None:
    """Otherwise a log could go back and forth between steps, and have any number of notes in each."""
    lines = [note_line(step, say=str(step)) for step in (3, 5, 4, 5)]
    assert [note.step for note in read_notes(lines, 0)] == [3, 5, 5]


def test_text_is_one_line_of_visible_characters_and_no_longer_than_allowed() -> None:
    hostile = "a\u202eb\n\x1b[31mc\ud800" + "d" * LONGEST_TEXT
    (note,) = read_notes([note_line(0, say=hostile)], 0)
    assert note.text.startswith("a b  [31mc d")
    assert len(note.text.encode()) == LONGEST_TEXT
