"""A model plays a seat: what is played of its answers, what it is told, and how its play ends."""

import json
from pathlib import Path
from typing import Any

import pytest
from tests.platform.wildscav.harness.played_seats import PlayedSeat, played
from tests.scripted_model import Answer, Call, Failed, Late, Said, called, cut, disturbed, in_turn, said

from wildscav.harness.answers import read_answer
from wildscav.harness.log import Log
from wildscav.harness.spending import Ending
from wildscav.notes import begin_step

GO = called("go", place="target")
WAITED = ("wait_until", {"seconds": 0.5})


def test_each_answer_is_played_until_the_match_is_over() -> None:
    course, seat, requests, _ = played(GO)

    assert seat.calls == [("go", {"place": "target"})] * 3
    assert (course.ending, course.spending.requests, course.spending.calls) == (Ending.MATCH_OVER, 3, 3)
    assert requests[0]["model"] == "scripted"  # the first that the server lists
    assert [tool["function"]["name"] for tool in requests[0]["tools"]] == ["go", "wait_until", "note"]
    assert [one["role"] for one in requests[1]["messages"]] == ["system", "user", "assistant", "tool"]
    assert requests[1]["messages"][-1]["content"].startswith("go ended after 1.0 s: done.")


def test_of_several_calls_the_first_is_played_and_the_others_are_refused() -> None:
    twice = Said(calls=(Call("go", '{"place": "a"}'), Call("go", '{"place": "b"}')))

    went = played(twice, PlayedSeat(2))

    assert went.seat.calls == [("go", {"place": "a"})] * 2
    assert "This call was not played" in went.told(1)


def test_prose_is_reminded_of_once_and_then_costs_game_time() -> None:
    prose = [said("I think."), said("I think on."), said("Well.")]
    course, seat, *_ = went = played(in_turn(*prose, GO, said("Hm."), GO), PlayedSeat(4))

    went_to = ("go", {"place": "target"})
    assert seat.calls == [WAITED, WAITED, went_to, went_to]  # after a call there is a reminder again
    assert course.spending.without_call == 4
    assert "costs 0.5 s of game time" in went.told(1).rpartition("I think.")[2]
    assert "so 0.5 s have passed" in went.told(2)


@pytest.mark.parametrize(
    "answer",
    [
        said(""),
        cut("go"),
        called("note", text="x"),
        cut("go", "[1]"),
        cut("go", '{"up": NaN}'),
        cut("go", '{"seconds": 1e999}'),
        cut("go", '{"up": %s}' % ("[" * 3_900 + "]" * 3_900)),
        called("refuse"),
        called("go", up="é" * 2000),
    ],
)
def test_an_answer_of_which_nothing_can_be_played_costs_the_same(answer: Answer) -> None:
    assert played(in_turn(answer, answer, GO), PlayedSeat(2)).seat.calls == [
        WAITED,
        ("go", {"place": "target"}),
    ]


def test_half_a_call_goes_back_to_the_server_as_valid_json() -> None:
    went = played(in_turn(cut("go"), GO), PlayedSeat(1))

    call = went.requests[1]["messages"][2]["tool_calls"][0]
    assert json.loads(call["function"]["arguments"]) == {}
    assert "not a JSON object" in went.told(1)


def test_ids_of_calls_that_no_server_takes_back_are_replaced() -> None:
    calls = [{"id": given, "function": {"name": "go"}} for given in ("call_1", "call_1", "\ud800", 3)]
    answer = read_answer({"choices": [{"message": {"tool_calls": calls}}]}, [], 7)

    assert [call.id for call in answer.calls] == ["call_1", "c00000701", "c00000702", "c00000703"]


def test_unknown_tools_and_wrong_arguments_are_for_the_seat_to_refuse() -> None:
    seat = played(in_turn(called("fly away!", up=1), called("go", wrong=[2])), PlayedSeat(2)).seat

    assert seat.calls == [("fly_away_", {"up": 1}), ("go", {"wrong": [2]})]


def test_notes_are_shown_every_time_and_the_oldest_are_dropped() -> None:
    both = Said(calls=(Call("note", '{"text": "It is north."}'), Call("go", "{}")))

    went = played(in_turn(both, GO), PlayedSeat(3), notes=20)
    crowded = played(in_turn(both, called("note", text="It is a trap."), GO), PlayedSeat(3), notes=20)

    assert all("Your notes:\nIt is north." in went.told(request) for request in (1, 2))
    assert "Your notes:\nIt is a trap." in crowded.told(3)


def test_old_exchanges_are_shortened_to_a_line() -> None:
    went = played(GO, PlayedSeat(7), window=4)

    assert [len(request["messages"]) for request in went.requests] == [2, 4, 6, 8, 10, 6, 8]
    lines = went.told(5).partition("What you did before:\n")[2].split("\n\n")[0]
    assert lines.splitlines() == ['- go {"place": "target"}: go ended after 1.0 s: done.'] * 3
    assert "Time: 3.0 s" in went.told(5)
    assert "Time: 2.0 s" not in went.told(5)


def test_a_conversation_that_is_too_long_for_the_server_is_shortened() -> None:
    def answer(messages: list[dict[str, Any]], _: object) -> Answer:
        return GO if len(messages) < 5 else Failed(400, "maximum context length")

    course, seat, *_ = played(answer, PlayedSeat(9))

    assert (course.ending, len(seat.calls)) == (Ending.MATCH_OVER, 9)


def test_a_model_sees_pictures_if_it_may() -> None:
    went = played(GO, PlayedSeat(2), pictures=True)

    shown = [message["content"] for message in went.requests[1]["messages"] if message["role"] == "user"]
    assert shown[1][-1]["image_url"]["url"] == "data:image/png;base64,UE5HIHdpdGggbWFya3M="
    assert sum("base64" in str(content) for content in shown) == 1


def test_what_it_says_is_a_note_for_those_who_watch(capsys: pytest.CaptureFixture[str]) -> None:
    begin_step(4)
    try:
        played(Said("I go \ud83d there.", calls=GO.calls), PlayedSeat(1))
    finally:
        begin_step(None)

    assert '{"step": 4, "say": "I go ? there."}' in capsys.readouterr().out


@pytest.mark.parametrize(
    ("budget", "ending"),
    [
        ({"tokens": 600}, Ending.OUT_OF_TOKENS),
        ({"seconds": 0.2}, Ending.OUT_OF_SECONDS),
        ({"money": 0.001, "prompt_price": 1.0, "answer_price": 4.0}, Ending.OUT_OF_MONEY),
    ],
)
def test_a_seat_whose_budget_is_spent_stands_still(budget: dict[str, Any], ending: Ending) -> None:
    course, seat, *_ = played(disturbed(lambda *_: GO, {3: Late(5.0)}), PlayedSeat(100), **budget)

    assert course.ending == ending
    assert seat.calls[-1] == ("wait_until", {"seconds": 60.0})


def test_the_log_has_every_request_and_answer_and_never_the_key(tmp_path: Path) -> None:
    log, key = tmp_path / "logs" / "model.jsonl", 'sk-"secret"'
    script = in_turn(Failed(500, f"your key is {key}"), Said(f"What is {key}?", calls=GO.calls))

    went = played(script, PlayedSeat(3), at_socket=False, key=key, log=log, pictures=True)

    text = log.read_text("utf-8")
    lines = [json.loads(line) for line in text.splitlines()]
    assert "secret" not in text
    kinds = [line["kind"] for line in lines]
    assert kinds == ["asked", "failed", *["asked", "answered"] * 3, "ended"]
    messages: list[Any] = []
    for line in lines:
        if line["kind"] == "asked":
            messages = messages[: line["kept"]] + line["messages"]
    assert len(messages) == len(went.requests[-1]["messages"])
    assert "base64" not in text


@pytest.mark.parametrize("placeholder", ["", "0", "x", "null", "EMPTY"])
def test_a_placeholder_for_a_key_leaves_the_log_as_it_is(tmp_path: Path, placeholder: str) -> None:
    Log(tmp_path / "model.jsonl", placeholder).answered({"text": "EMPTY x 0", "calls": None}, 1.0)

    line = json.loads((tmp_path / "model.jsonl").read_text("utf-8"))
    assert line["answer"] == {"text": "EMPTY x 0", "calls": None}
