"""What a server counts and writes down."""

import asyncio
import json
import urllib.request
from pathlib import Path

import grpc
import pytest
from tests.platform.helpers.seats import connected, host, serving, small_spec

from wildscav.proto.match_pb2 import ClientMessage, Join
from wildscav_server.match_server import MatchServer
from wildscav_server.monitoring.logs import open_log
from wildscav_server.monitoring.metrics import serving_metrics


async def a_match_and_a_refusal(server: MatchServer, address: str) -> None:
    """Play a match of two seats, one of which leaves; refuse a client twice; leave a match open."""
    hosted = await host(server, small_spec(seats=2))
    async with connected(address) as good, connected(address) as leaver:
        named = Join(
            token=hosted.tokens[0], protocol_version=1, sdk_name="a client\n" + "x" * 200, sdk_version="1.2"
        )
        await good.send(ClientMessage(join=named))
        await good.read()
        await leaver.join(hosted.tokens[1])
        await leaver.call.done_writing()
        await good.play_out()
    await hosted.finished()
    for _ in range(2):
        async with connected(address) as client:
            await client.send(ClientMessage(join=Join(token="wrong", protocol_version=1)))  # noqa: S106
            with pytest.raises(grpc.aio.AioRpcError):
                await client.read_out()
    await host(server, small_spec())


def fetch(address: str) -> str:
    with urllib.request.urlopen(address) as answer:  # noqa: S310
        return str(answer.read().decode())


def test_metrics_tell_matches_steps_latency_queue_and_faults(tmp_path: Path) -> None:
    async def play(server: MatchServer, address: str) -> str:
        await a_match_and_a_refusal(server, address)
        with serving_metrics(server.metrics, 0) as metrics:
            assert metrics is not None
            return await asyncio.to_thread(fetch, metrics)

    lines = serving(tmp_path, play).splitlines()

    for line in (
        'wildscav_server_matches_total{how="finished",track="gathering"} 1.0',
        'wildscav_server_matches_open{state="joining"} 1.0',
        'wildscav_server_matches_open{state="playing"} 0.0',
        'wildscav_server_seats_total{fault="",status="finished"} 1.0',
        'wildscav_server_seats_total{fault="agent",status="crashed"} 1.0',
        "wildscav_server_steps_total 20.0",
        "wildscav_server_late_steps_total 0.0",
        "wildscav_server_step_latency_seconds_count 20.0",
        'wildscav_server_step_latency_seconds_bucket{le="+Inf"} 20.0',
        'wildscav_server_refusals_total{reason="SEAT_TOKEN_UNKNOWN"} 2.0',
        "wildscav_server_strangers 0.0",
    ):
        assert line in lines, "\n".join(lines)


def test_a_log_has_a_line_for_everything_that_happens(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    serving(tmp_path, a_match_and_a_refusal, log=open_log("json"))

    lines = [json.loads(line) for line in capsys.readouterr().err.splitlines()]

    assert [line["event"] for line in lines] == [
        *("match_opened", "seat_ended", "seat_ended", "match_finished"),
        *("refused", "match_opened", "match_cancelled"),  # the second refusal within a second is only counted
    ]
    opened, _, crashed, finished, refused, *_ = lines
    assert opened["track"] == "gathering"
    assert (crashed["status"], crashed["fault"], crashed["level"]) == ("crashed", "agent", "warning")
    assert (finished["match"], finished["steps"]) == (opened["match"], 20)
    names = {line["seat"]: line["sdk"] for line in lines if line["event"] == "seat_ended"}
    assert names == {0: "a client?" + "x" * 91 + " 1.2", 1: ""}
    assert refused["reason"] == "SEAT_TOKEN_UNKNOWN"
