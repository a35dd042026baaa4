"""What a seat gets of its model: answers, counted tokens, a budget, and whose fault a failure is."""

import asyncio
import gzip
import json
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator.model_gateway.served import KEY, Serve, Served
from tests.scripted_model import (
    NO_CHOICES,
    Answer,
    Endless,
    Failed,
    Late,
    Messages,
    Raw,
    Reset,
    Said,
    called,
    disturbed,
    in_turn,
    said,
    too_many,
)

from wildscav_evaluator.model_gateway import exchanges
from wildscav_evaluator.model_gateway import serve as serving
from wildscav_evaluator.model_gateway.accounts import Accounts
from wildscav_evaluator.model_gateway.chat import ChatAnswer
from wildscav_evaluator.model_gateway.model_server import ModelServer
from wildscav_evaluator.model_gateway.settings import ModelSettings

TOOL = {"type": "function", "function": {"name": "go", "parameters": {"type": "object"}}}
YES = in_turn(said("yes"))


def test_a_seat_gets_the_answer_and_nothing_else_of_the_server(serve: Serve) -> None:
    async def ask(gateway: Served) -> None:
        answer = await gateway.ask("Where?", tools=[TOOL], temperature=0.5, user="spy", n=9, max_tokens=900)
        document = answer.json()
        assert gateway.accounts.tokens(0) == document["usage"]["total_tokens"] > 0
        assert gateway.accounts.tokens(1) == 0
        (choice,) = document["choices"]
        assert choice["message"]["tool_calls"][0]["function"]["arguments"] == '{"place": "target"}'
        assert (choice["finish_reason"], document["model"]) == ("tool_calls", "tiny")

    gateway = serve(in_turn(called("go", place="target")), ask, max_tokens=50, extra={"top_k": 5})

    assert gateway.requests[0].body == {
        "messages": [{"role": "user", "content": "Where?"}],
        "tools": [TOOL],
        "temperature": 0.5,
        "top_k": 5,
        "model": "tiny",
        "max_tokens": 50,
    }


@pytest.mark.parametrize("usage", [None, "many", {"prompt_tokens": 10**9, "completion_tokens": -1}, [7]])
def test_a_server_that_counts_nothing_or_nonsense_is_estimated(serve: Serve, usage: object) -> None:
    async def ask(gateway: Served) -> None:
        counted = (await gateway.ask("x" * 400)).json()["usage"]
        asked, answered = '{"messages": [{"role": "user", "content": ""}]}', '{"content": ""}'
        assert counted["prompt_tokens"] == (len(asked) + 400) // 4
        assert counted["completion_tokens"] == (len(answered) + 40) // 4

    serve(in_turn(Said("y" * 40, usage=usage)), ask)


@pytest.mark.parametrize(
    ("budget", "reason"),
    [
        ({"requests": 2}, "its 2 requests to the model are used up"),
        ({"tokens": 60}, "of 60 tokens are used up"),
        ({"seconds": 1e-9}, "of the model's time are used up"),
        ({"money": 1e-6, "answer_price": 1.0}, "of money for the model are used up"),
    ],
)
def test_a_budget_that_is_spent_ends_a_seat_and_no_other(
    serve: Serve, budget: dict[str, Any], reason: str
) -> None:
    async def ask(gateway: Served) -> None:
        answers = [await gateway.ask("Where should I go now, please?") for _ in range(4)]
        refused = next(one for one in answers if one.status_code != 200)
        error = refused.json()["error"]
        assert (refused.status_code, error["code"]) == (429, "insufficient_quota")
        assert reason in error["message"]
        assert gateway.reports == [{"ready": True}, {"over": 0, "reason": error["message"]}]
        assert gateway.accounts.is_over(0)
        assert (await gateway.ask("And I?", seat=1)).status_code == 200

    serve(in_turn(said("To the target, and then on to the next one.")), ask, **budget)


def test_money_is_spent_when_the_next_prompt_would_spend_it(tmp_path: Path) -> None:
    accounts = Accounts.make(tmp_path / "accounts", [0])
    settings = ModelSettings(url="http://host/v1", name="tiny", money=2e-5, prompt_price=1.0)

    assert accounts.spent(0, settings, prompt=19) == ""
    assert accounts.spent(0, settings, prompt=20) == "its 2e-05 of money for the model are used up"


def test_an_answer_may_not_be_longer_than_what_is_left_of_the_budget(serve: Serve) -> None:
    gateway = serve(YES, lambda gateway: gateway.ask("x" * 40), tokens=100, max_tokens=1000)

    assert gateway.requests[0].body["max_tokens"] == 100 - 21


NO_REQUESTS_FAULT = [Failed(401, "Incorrect API key provided"), too_many()]
BROKEN = [
    Failed(500),
    Reset(),
    Raw(b"<html>"),
    NO_CHOICES,
    Endless(),
    Late(30.0),
    Failed(400, "unknown field top_k"),  # of which the seat knows nothing
]


@pytest.mark.parametrize("broken", [*BROKEN, *NO_REQUESTS_FAULT, None], ids=str)
def test_a_server_that_fails_for_everybody_is_the_platforms_fault(
    serve: Serve, broken: Answer | None
) -> None:
    async def ask(gateway: Served) -> None:
        assert (await gateway.ask("Where?")).status_code == 503
        assert [one.keys() for one in gateway.reports] == [{"ready"}, {"fault"}]
        assert KEY not in str(gateway.reports)
        if broken is None:
            why = "the model's server at 127.0.0.1:9 fails: Connection refused; is it running?"
            assert gateway.reports[1]["fault"] == why

    serve("http://127.0.0.1:9/v1" if broken is None else in_turn(broken), ask, timeout=0.3, retries=1)


def for_evil(broken: Answer) -> Any:
    """Return a script that fails for some words alone."""

    def script(messages: Messages, _: object) -> Answer:
        return broken if messages[-1]["content"] == "evil" else said("yes")

    return script


class Impatient(ModelServer):
    """Waits a short time for evil requests, and a long one for others."""

    async def _post(self, body: bytes) -> ChatAnswer:
        timeout = 0.3 if b"evil" in body else 30.0
        self._settings = self._settings.model_copy(update={"timeout": timeout})
        return await super()._post(body)


@pytest.mark.parametrize("status", [429, 503])
def test_an_overloaded_server_is_waited_for_and_blamed_on_no_seat(serve: Serve, status: int) -> None:
    async def ask(gateway: Served) -> None:
        assert (await gateway.ask("evil")).status_code == 503
        assert f"is overloaded: status {status}" in gateway.reports[-1]["fault"]

    assert len(serve(for_evil(Failed(status)), ask, timeout=0.3, retries=0).requests) > 1


@pytest.mark.parametrize("broken", BROKEN)
def test_a_request_that_breaks_a_server_which_works_is_its_seats_fault(
    serve: Serve, monkeypatch: pytest.MonkeyPatch, broken: Answer
) -> None:
    monkeypatch.setattr(serving, "ModelServer", Impatient)

    async def ask(gateway: Served) -> None:
        refused = await gateway.ask("evil")
        assert refused.status_code in (400, 502)
        assert "the model's server failed this request" in refused.json()["error"]["message"]
        assert gateway.reports == [{"ready": True}]
        assert gateway.accounts.tokens(0) > 0

    serve(for_evil(broken), ask, retries=0)


def test_an_answer_that_comes_too_late_is_not_asked_for_in_secret(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serving, "ModelServer", Impatient)

    async def ask(gateway: Served) -> None:
        answers = [await gateway.ask(said) for said in ("good", "evil", "good")]
        assert [one.status_code for one in answers] == [200, 502, 200]

    gateway = serve(for_evil(Late(30.0)), ask, retries=0)

    asked = [one.body["messages"][0]["content"] for one in gateway.requests]
    assert asked == ["good", "evil", "Answer with the word yes.", "good"]


def test_a_connection_that_ends_as_a_request_is_sent_is_nobodys_fault(serve: Serve) -> None:
    async def ask(gateway: Served) -> None:
        assert [(await gateway.ask("Where?")).status_code for _ in range(2)] == [200, 200]

    assert serve(disturbed(YES, {1: Reset()}), ask, retries=0).reports == [{"ready": True}]


def test_a_short_failure_of_the_server_is_nobodys_fault(serve: Serve) -> None:
    async def ask(gateway: Served) -> None:
        assert (await gateway.ask("Where?")).status_code == 200

    assert serve(disturbed(YES, {0: Failed(503), 1: Reset()}), ask).reports == [{"ready": True}]


def test_the_file_has_what_was_asked_and_answered_and_each_message_once(serve: Serve) -> None:
    async def ask(gateway: Served) -> None:
        await gateway.ask("first", tools=[TOOL])
        await gateway.ask("first", "second", tools=[TOOL])
        await gateway.ask("first", seat=1)

    file = serve(YES, ask).folder / "exchanges.jsonl.gz"

    text = gzip.decompress(file.read_bytes()).decode()
    assert KEY not in text
    lines = [json.loads(line) for line in text.splitlines()]
    known = {(one["seat"], one["digest"]): one["is"] for one in lines if "digest" in one}
    requests = [one for one in lines if "request" in one]
    assert len(known) == 4  # the tools, and one, two and one messages
    said_by_each = [
        [known[one["seat"], name]["content"] for name in one["request"]["messages"]] for one in requests
    ]
    assert said_by_each == [["first"], ["first", "second"], ["first"]]
    assert [one["answer"]["message"]["content"] for one in requests] == ["yes"] * 3
    assert [(one["seat"], one["number"]) for one in requests] == [(0, 1), (0, 2), (1, 1)]


def test_nothing_more_is_written_once_a_share_is_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def write() -> None:
        with exchanges.Exchanges(tmp_path / "exchanges.jsonl.gz") as file:
            await file.write(0, 1, {"messages": ["first"]}, {})
            monkeypatch.setattr(exchanges, "sha256", None)  # nothing is hashed either
            await file.write(0, 2, {"messages": ["second"]}, {})

    monkeypatch.setattr(exchanges, "MOST", 10)
    asyncio.run(write())

    assert gzip.decompress((tmp_path / "exchanges.jsonl.gz").read_bytes()) == b'{"seat": 0, "cut": true}\n'


def test_nothing_of_one_seat_reaches_the_requests_of_another(serve: Serve) -> None:
    async def ask(gateway: Served) -> None:
        await asyncio.gather(gateway.ask("mine"), gateway.ask("yours", seat=1), gateway.ask("mine"))

    requests = serve(YES, ask, cache_salt=True).requests

    salts = {one.body["messages"][0]["content"]: one.body["cache_salt"] for one in requests}
    assert [len(one.body["messages"]) for one in requests] == [1, 1, 1]
    assert salts["mine"] != salts["yours"]
    headers = {name.lower() for one in requests for name in one.headers}
    assert not headers & {"cookie", "x-seat", "user"}
