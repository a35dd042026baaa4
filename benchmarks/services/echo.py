"""A bare ``grpc.aio`` stream that carries the messages of a match: the least that a step can cost.

``python echo.py serve ADDRESS MESSAGES`` sends the messages of a file one after the other, each after the
answer to the previous one. ``python echo.py play ADDRESS ROUNDS`` answers them and prints the rounds a
second. Both parse the messages that they receive.
"""

import asyncio
import io
import sys
import time
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

import grpc
from google.protobuf import proto

from wildscav.proto.match_pb2 import Action, ClientMessage, ServerMessage

METHOD = "/wildscav.benchmark.Echo/Play"
WARM_UP = 50  # rounds


def write_messages(path: Path, messages: Sequence[ServerMessage]) -> None:
    """Write messages into a file."""
    with path.open("wb") as file:
        for message in messages:
            proto.serialize_length_prefixed(message, file)


def read_messages(path: Path) -> list[ServerMessage]:
    """Read the messages of a file."""
    file = io.BytesIO(path.read_bytes())
    return list(iter(lambda: proto.parse_length_prefixed(ServerMessage, file), None))


async def serve(address: str, messages: Sequence[ServerMessage]) -> None:
    """Serve until killed."""

    async def play(
        _: AsyncIterator[ClientMessage], context: "grpc.aio.ServicerContext[ClientMessage, ServerMessage]"
    ) -> None:
        number = 0
        await context.write(messages[0])
        while await context.read() is not grpc.aio.EOF:
            number = (number + 1) % len(messages)
            await context.write(messages[number])

    server = grpc.aio.server()
    handler = grpc.stream_stream_rpc_method_handler(
        play,
        request_deserializer=ClientMessage.FromString,
        response_serializer=ServerMessage.SerializeToString,
    )
    service = grpc.method_handlers_generic_handler("wildscav.benchmark.Echo", {"Play": handler})
    server.add_generic_rpc_handlers((service,))
    server.add_insecure_port(address)
    await server.start()
    print("ready", flush=True)
    await server.wait_for_termination()


async def play(address: str, rounds: int) -> float:
    """Return how many rounds a second a client gets."""
    answer = ClientMessage(action=Action(step=1000, walk_direction=10.0, walk_speed=6.0))
    started = 0.0
    async with grpc.aio.insecure_channel(address) as channel:
        call = channel.stream_stream(
            METHOD,
            request_serializer=ClientMessage.SerializeToString,
            response_deserializer=ServerMessage.FromString,
        )()
        for number in range(WARM_UP + rounds):
            if number == WARM_UP:
                started = time.perf_counter()
            await call.read()
            await call.write(answer)
        seconds = time.perf_counter() - started
        await call.done_writing()
    return rounds / seconds


if __name__ == "__main__":
    if sys.argv[1] == "serve":
        asyncio.run(serve(sys.argv[2], read_messages(Path(sys.argv[3]))))
    else:
        print(asyncio.run(play(sys.argv[2], int(sys.argv[3]))))
