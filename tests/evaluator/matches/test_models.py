"""Agents without a network ask a model in a match: by their own sockets, at no other's cost."""

import asyncio
import gzip
import json
from pathlib import Path
from typing import Any

import pytest
from tests.evaluator import small_matches
from tests.evaluator.sample_agents import ASKER, TALKER, Submit
from tests.scripted_model import Answer, Failed, Messages, ScriptedModel, disturbed, in_turn, said

from wildscav_evaluator.matches.play import PlatformFaultError, PlayedMatch
from wildscav_evaluator.model_gateway import model_server
from wildscav_evaluator.model_gateway.gateway import ModelFaultError, open_gateway
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.submissions.submission import Submission

pytestmark = pytest.mark.usefixtures("compiled")
STEPS = 5
KEY = "sk-the-organizers-own"
# Looks for the key and for other sockets.
SPY = (
    ASKER
    + """
    def reset(self, match):
        print("sockets", sorted(one for one in os.listdir("/run/wildscav") if one.endswith("sock")))
        print("key", "sk-the-organizers-own" in str(os.environ))
        print("processes", any(b"model_gateway" in open(f"/proc/{one}/cmdline", "rb").read()
            for one in os.listdir("/proc") if one.isdecimal()))
"""
)
ISOLATED = ["bubblewrap", pytest.param("oci", marks=pytest.mark.slow)]


def play(
    *submissions: Submission, model: ScriptedModel, tmp_path: Path, sandbox: str = "process", **settings: Any
) -> PlayedMatch:
    asked = ModelSettings(url=model.url, name="tiny", key_env="MODEL_KEY", retries=0, **settings)
    exchanges = tmp_path / "exchanges.jsonl.gz"
    options = {"seconds": STEPS / 10, "model": asked, "exchanges": exchanges}
    return small_matches.play(small_matches.seated(*submissions, folder=tmp_path, **options), sandbox)


@pytest.fixture(autouse=True)
def _key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MODEL_KEY", KEY)
    monkeypatch.setattr("wildscav_evaluator.matches.play.RETRY_DELAY", 0.0)
    monkeypatch.setattr(model_server, "FIRST_PAUSE", 0.01)


@pytest.mark.parametrize("sandbox", ["process", *ISOLATED])
def test_two_seats_ask_by_sockets_of_their_own(submit: Submit, tmp_path: Path, sandbox: str) -> None:
    with ScriptedModel(in_turn(said("go on")), key=KEY) as model:
        played = play(
            submit("first", SPY if sandbox != "process" else ASKER),
            submit("second", ASKER),
            model=model,
            tmp_path=tmp_path,
            sandbox=sandbox,
        )

    assert {(seat.status, seat.steps_played) for seat in played.seats.values()} == {("finished", STEPS)}
    assert len(model.requests) == 2 * STEPS
    log = (tmp_path / "0.log").read_text()
    assert log.count("go on") == STEPS
    if sandbox != "process":
        assert "sockets ['match.sock', 'model.sock']" in log
        assert "key False" in log
        assert "processes False" in log
    text = gzip.decompress((tmp_path / "exchanges.jsonl.gz").read_bytes()).decode()
    seats = [one["seat"] for line in text.splitlines() if "answer" in (one := json.loads(line))]
    assert sorted(seats) == [0] * STEPS + [1] * STEPS
    assert KEY not in text


def test_a_spent_budget_ends_its_seat_and_no_other(submit: Submit, tmp_path: Path) -> None:
    with ScriptedModel(in_turn(said("go on")), key=KEY) as model:
        played = play(
            submit("greedy", ASKER), submit("other", TALKER), model=model, tmp_path=tmp_path, requests=2
        )

    assert [seat.status for seat in played.seats.values()] == ["over_budget", "finished"]
    assert played.seats[0].detail == "its 2 requests to the model are used up"
    assert played.seats[0].status.fault == "agent"
    assert played.seats[1].steps_played == STEPS


def test_a_gateway_that_cannot_start_says_so(tmp_path: Path) -> None:
    (tmp_path / "file").touch()

    async def start() -> None:
        async with open_gateway(
            ModelSettings(url="http://host/v1", name="tiny"), {0: tmp_path}, tmp_path / "file/exchanges"
        ):
            pass

    with pytest.raises(ModelFaultError, match=r"does not start: .*Error: "):
        asyncio.run(start())


def fails(first: int) -> Any:
    return disturbed(in_turn(said("go on")), dict.fromkeys(range(first), Failed(500)))


def test_a_match_that_the_models_server_failed_is_played_again(submit: Submit, tmp_path: Path) -> None:
    with ScriptedModel(fails(2), key=KEY) as model:  # the seat's request, and the gateway's own question
        played = play(submit("asker", ASKER), model=model, tmp_path=tmp_path)

    (fault,) = played.platform_faults
    assert "the model's server at 127.0.0.1:" in fault
    assert "fails: status 500: the server failed" in fault
    assert (played.seats[0].status, played.seats[0].steps_played) == ("finished", STEPS)


def test_a_server_that_fails_for_ever_is_blamed_on_no_seat(submit: Submit, tmp_path: Path) -> None:
    with (
        ScriptedModel(in_turn(Failed(500))) as model,
        pytest.raises(PlatformFaultError, match="failed 3 times"),
    ):
        play(submit("asker", ASKER), model=model, tmp_path=tmp_path)


def test_a_request_that_breaks_the_server_gives_its_seat_no_other_match(
    submit: Submit, tmp_path: Path
) -> None:
    def script(messages: Messages, _: object) -> Answer:
        return Failed(500) if "asker" in messages[-1]["content"] else said("yes")

    with ScriptedModel(script, key=KEY) as model:
        played = play(submit("asker", ASKER), submit("other", ASKER), model=model, tmp_path=tmp_path)

    assert played.platform_faults == ()
    assert {seat.status for seat in played.seats.values()} == {"finished"}
    assert "502 {" in (tmp_path / "0.log").read_text()
    assert "502 {" not in (tmp_path / "1.log").read_text()
