"""A bare gRPC stream that sends messages to and fro: the least that a step over gRPC can cost.

As a script it is the client: ``python echo.py ADDRESS ROUNDS ANSWER_BYTES`` prints rounds a second.
"""

import asyncio
import sys
import time
from collections.abc import AsyncIterator

import grpc

METHOD = "/wildscav.benchmark.Echo/Play"
WARM_UP = 20  # rounds


async def serve(address: str, message_bytes: int) -> grpc.aio.Server:
    """Start a server that sends a message, waits for the answer, and so on."""

    async def play(_: AsyncIterator[bytes], context: grpc.aio.ServicerContext[bytes, bytes]) -> None:
        message = bytes(message_bytes)
        await context.write(message)
        while await context.read() is not grpc.aio.EOF:
            await context.write(message)

    server = grpc.aio.server()
    handlers = {"Play": grpc.stream_stream_rpc_method_handler(play)}
    server.add_generic_rpc_handlers(
        (grpc.method_handlers_generic_handler("wildscav.benchmark.Echo", handlers),)
    )
    server.add_insecure_port(address)
    await server.start()
    return server


async def play(address: str, rounds: int, answer_bytes: int) -> float:
    """Return how many rounds a second a client gets."""
    answer, started = bytes(answer_bytes), 0.0
    async with grpc.aio.insecure_channel(address) as channel:
        call = channel.stream_stream(METHOD)()
        for number in range(WARM_UP + rounds):
            if number == WARM_UP:
                started = time.perf_counter()
            await call.read()
            await call.write(answer)
        seconds = time.perf_counter() - started
        await call.done_writing()
    return rounds / seconds


if __name__ == "__main__":
    print(asyncio.run(play(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))))
