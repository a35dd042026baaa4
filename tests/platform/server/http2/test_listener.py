"""Who is let in, and when: unknown clients share one part of the time, and each of them gets a turn."""

import asyncio
import socket
import ssl
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path

from tests.platform.helpers.certificates import Authority
from tests.platform.helpers.raw_http2 import GREETING, SETTINGS, frame

from wildscav_server.endpoints.tls import Certificate
from wildscav_server.http2.accounting import TimeShare
from wildscav_server.http2.connection import Listener
from wildscav_server.http2.encryption import Encryption

PREFACE = GREETING + frame(SETTINGS, 0, 0)
UNKNOWN_FRAME = bytes([0, 0x40, 0, 0xFF, 0, 0, 0, 0, 0])  # 16,384 bytes of a kind that nobody knows
REST = 0.005  # s that unknown clients wait after each thing that was done for one


class OneThingAtATime(TimeShare):
    """A share that is used up by whatever is done, and back after a rest."""

    def __init__(self, clock: Callable[[], float]) -> None:
        super().__init__(clock)
        self._clock, self._until, self._spent = clock, 0.0, 0
        self.used_up = asyncio.get_running_loop().create_future()  # done when twenty things were done

    def spend(self, cost: float) -> None:
        self._spent, self._until = self._spent + 1, self._clock() + REST
        if self._spent == 20:
            self.used_up.set_result(None)

    def wait(self) -> float:
        return max(0.0, self._until - self._clock())


async def listening(tls: ssl.SSLContext | None = None) -> tuple[Listener, OneThingAtATime, int]:
    at = socket.create_server(("127.0.0.1", 0))
    listener = Listener([at], {}, connections=10, tls=tls)
    listener.share = share = OneThingAtATime(asyncio.get_running_loop().time)
    listener.start()
    return listener, share, at.getsockname()[1]


def run(rule: Callable[[], Awaitable[None]]) -> None:
    async def within_a_minute() -> None:
        async with asyncio.timeout(60):
            await rule()

    asyncio.run(within_a_minute())


async def call(port: int, first: bytes = b"") -> socket.socket:
    calling = socket.socket()
    calling.setblocking(False)
    loop = asyncio.get_running_loop()
    await loop.sock_connect(calling, ("127.0.0.1", port))
    await loop.sock_sendall(calling, first)
    return calling


def test_an_unknown_client_that_never_stops_sending_keeps_nobody_out() -> None:
    async def rule() -> None:
        loop = asyncio.get_running_loop()
        listener, share, port = await listening()
        with await call(port, PREFACE + UNKNOWN_FRAME) as talker:

            async def talk() -> None:
                while True:
                    await loop.sock_sendall(talker, b"x")
                    await asyncio.sleep(0.001)

            talking = asyncio.create_task(talk())
            await share.used_up
            with await call(port) as other:
                assert await loop.sock_recv(other, 9), "the other was greeted"
                assert len(listener._open) == 2, "the other came in only after the talker was put out"
            talking.cancel()
        await listener.stop(0.0)

    run(rule)


def test_what_an_unknown_client_sends_before_the_handshake_is_done_is_counted(tmp_path: Path) -> None:
    pair = Authority(tmp_path, "authority").sign("server")
    tls = Certificate(str(pair.cert), str(pair.key)).context()

    async def rule() -> None:
        listener, share, port = await listening(tls)
        with await call(port, bytes([22, 3, 1, 2, 0])) as calling:  # a record of 512 bytes begins
            while not share.used_up.done():  # and comes in scraps
                await asyncio.get_running_loop().sock_sendall(calling, b"\x01")
                await asyncio.sleep(0.001)
        await listener.stop(0.0)

    run(rule)


def test_an_encrypted_message_longer_than_a_record_arrives_whole(tmp_path: Path) -> None:
    authority = Authority(tmp_path, "authority")
    pair = authority.sign("server")
    server = Certificate(str(pair.cert), str(pair.key)).context()
    message = bytes(range(256)) * 1000

    here = Encryption(server)
    incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
    context = ssl.create_default_context(cafile=str(authority.path))
    client = context.wrap_bio(incoming, outgoing, server_hostname="localhost")
    for _ in range(3):
        with suppress(ssl.SSLWantReadError):
            client.do_handshake()
        assert here.decrypt(outgoing.read()) == b""
        incoming.write(here.pending_output())

    incoming.write(here.encrypt(message))
    arrived = b""
    while len(arrived) < len(message):
        arrived += client.read(65_536)
    assert arrived == message
    for _ in range(0, len(message), 16_384):
        client.write(message[:16_384])
    assert len(here.decrypt(outgoing.read())) == 16_384 * 16
    assert here.end()
