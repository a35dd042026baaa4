"""A model's server misbehaves: what is tried again, what ends the model's play, and what is counted."""

import time
from dataclasses import replace

import pytest
from tests.platform.wildscav.harness.played_seats import PlayedSeat, played
from tests.scripted_model import (
    NO_CHOICES,
    Answer,
    Endless,
    Failed,
    Late,
    Raw,
    Reset,
    called,
    disturbed,
    in_turn,
    too_many,
)

from wildscav.errors import UserError
from wildscav.harness.player import ModelPlayer
from wildscav.harness.settings import ModelSettings
from wildscav.harness.spending import Ending

GO = called("go", place="target")
FAILURES: dict[str, Answer] = {
    "500": Failed(500),
    "502 without a body": Raw(b"", 502),
    "too many requests": too_many(),
    "reset": Reset(),
    "late": Late(5.0, GO),
    "flood": Endless(),
    "drip": Endless(pause=0.01),
    "no choices": NO_CHOICES,
    "no JSON": Raw(b"<html>Bad gateway</html>"),
    "deep JSON": Raw(b"[" * 100_000),
    "deep message": Raw(b'{"choices": [{"message": {"content": %s}}]}' % (b"[" * 900 + b"]" * 900)),
    "no message": Raw(b'{"choices": [{"message": "hello"}]}'),
}
at_both = pytest.mark.parametrize("at_socket", [True, False], ids=["socket", "URL"])


@pytest.mark.parametrize("failure", FAILURES)
def test_what_may_pass_is_tried_again(failure: str) -> None:
    script = disturbed(lambda *_: GO, {1: FAILURES[failure]})
    patience = {"timeout": 0.3, "retries": 50} if failure in ("late", "drip") else {}

    course, seat, *_ = played(script, PlayedSeat(3), at_socket=False, **patience)

    assert seat.calls == [("go", {"place": "target"})] * 3
    assert course.ending == Ending.MATCH_OVER
    assert course.spending.failures == 1 or patience  # a busy machine may be late as well


@at_both
@pytest.mark.parametrize("failure", ["500", "reset", "flood", "no choices"])
def test_a_server_that_fails_to_the_end_ends_the_models_play(failure: str, at_socket: bool) -> None:
    course, seat, requests, _ = played(in_turn(GO, FAILURES[failure]), at_socket=at_socket)

    assert course.ending == Ending.MODEL_FAILED
    assert course.detail
    assert len(requests) == (2 if at_socket else 4)  # one, and three tries, which a gateway makes itself
    assert seat.calls[1:] == [("wait_until", {"seconds": 60.0})] * 2


def test_a_gateway_is_waited_for() -> None:
    course, *_ = played(disturbed(lambda *_: GO, {1: Late(0.5, GO)}), timeout=0.1)

    assert (course.ending, course.spending.failures) == (Ending.MATCH_OVER, 0)


def test_a_server_is_given_the_time_that_it_asks_for() -> None:
    began = time.monotonic()
    played(disturbed(lambda *_: GO, {0: too_many(0.2)}), PlayedSeat(1), at_socket=False)

    assert time.monotonic() - began >= 0.2


def test_no_try_is_made_for_which_no_time_is_left() -> None:
    course, _, requests, _ = played(too_many(60.0), at_socket=False, seconds=5.0)

    assert (course.ending, len(requests)) == (Ending.OUT_OF_SECONDS, 1)


@pytest.mark.parametrize(
    ("failure", "ending"),
    [
        (Failed(401, "the key is wrong"), Ending.REQUEST_REFUSED),
        (Failed(404, "no such model"), Ending.REQUEST_REFUSED),
        (Failed(400, "no tools here"), Ending.REQUEST_REFUSED),
        (Raw(b'{"error": {"message": "spent", "code": "insufficient_quota"}}', 429), Ending.OUT_OF_QUOTA),
    ],
    ids=repr,
)
@at_both
def test_what_cannot_pass_is_not_tried_again(failure: Answer, ending: Ending, at_socket: bool) -> None:
    course, _, requests, _ = played(failure, at_socket=at_socket)

    assert (course.ending, len(requests)) == (ending, 1)


def test_a_server_gets_the_key() -> None:
    went = played(GO, at_socket=False, key="sk-secret")

    assert "Bearer sk-secret" in went.model.requests[0].headers.values()


@pytest.mark.parametrize("url", ["http://127.0.0.1:9/v1", "unix:/nowhere/model.sock"])
def test_a_server_that_does_not_exist_has_failed(url: str) -> None:
    course = ModelPlayer(PlayedSeat(), ModelSettings(url=url, pause=0.0)).play()

    assert course.ending == Ending.MODEL_FAILED
    assert "cannot be reached" in course.detail


@pytest.mark.parametrize(
    "usage", [None, "many", [], {}, {"prompt_tokens": -5, "completion_tokens": 1e30}], ids=repr
)
def test_tokens_are_estimated_where_a_server_does_not_count_right(usage: object) -> None:
    counted = played(GO).course.spending
    estimated = played(replace(GO, usage=usage)).course.spending

    assert estimated.prompt_tokens == pytest.approx(counted.prompt_tokens, rel=0.3)
    assert estimated.answer_tokens == pytest.approx(counted.answer_tokens, rel=0.3)


@pytest.mark.parametrize("url", ["http://[::bad", "http:///v1", "http://a b/v1", "http://a:b"])
def test_an_address_that_is_none_is_refused(url: str) -> None:
    with pytest.raises(UserError, match="not valid"):
        ModelPlayer(PlayedSeat(), ModelSettings(url=url))
