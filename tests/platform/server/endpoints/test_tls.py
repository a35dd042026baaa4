"""TLS between agents and a server, with real certificates; what is wrong with one is told in a line."""

import asyncio
import os
import sys
from pathlib import Path

import grpc
import pytest
from tests.platform.helpers.certificates import DAY, Authority, Pair
from tests.platform.helpers.seats import AGENTS, Served, ended, host, serving, small_spec, with_server

from wildscav.errors import UserError
from wildscav.proto.match_pb2 import HostMatchRequest
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.wire.matches import decode_seat_address
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.endpoints.tls import Certificate
from wildscav_server.match_server import MatchServer
from wildscav_server.workers.shared_server import SharedServer


def guarded(server: Pair, client_ca: Path | None = None) -> EndpointSettings:
    files = Certificate(str(server.cert), str(server.key), str(client_ca) if client_ca else None)
    return EndpointSettings(tls=files.context())


async def start(address: str, token: str, *options: str | Path) -> asyncio.subprocess.Process:
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "wildscav.sdk", "agents:Walker", *map(str, options)),
        cwd=AGENTS,
        env={**os.environ, "WILDSCAV_ADDRESS": address, "WILDSCAV_TOKEN": token},
        stderr=asyncio.subprocess.PIPE,
    )


def joined(
    tmp_path: Path, endpoint_settings: EndpointSettings, *options: str | Path
) -> tuple[int | None, str]:
    """Let an agent play a match on a port of a server; return how its process ended."""

    async def play(_: MatchServer, __: str) -> tuple[int | None, str]:
        server = MatchServer(endpoint_settings=endpoint_settings)
        (address,) = await server.start(["127.0.0.1:0"])
        hosted = await host(server, small_spec(seconds=0.5))
        how = await ended(await start(address, hosted.tokens[0], *options))
        hosted.cancel()
        await server.stop()
        return how

    return serving(tmp_path, play)


def test_an_agent_plays_over_tls(tmp_path: Path) -> None:
    authority = Authority(tmp_path, "authority")

    assert joined(tmp_path, guarded(authority.sign("server")), "--ca", authority.path) == (0, "")


def test_with_a_client_ca_only_known_clients_play(tmp_path: Path) -> None:
    authority, own = Authority(tmp_path, "authority"), Authority(tmp_path, "clients")
    endpoint_settings, me, other = (
        guarded(authority.sign("server"), own.path),
        own.sign("me"),
        authority.sign("other"),
    )

    known = joined(tmp_path, endpoint_settings, "--ca", authority.path, "--cert", me.cert, "--key", me.key)
    unknown = joined(tmp_path, endpoint_settings, "--ca", authority.path)
    wrong = joined(
        tmp_path, endpoint_settings, "--ca", authority.path, "--cert", other.cert, "--key", other.key
    )

    assert known == (0, "")
    for (code, said), problem in ((unknown, "none is given"), (wrong, "the one given is not accepted")):
        assert (code, len(said.splitlines())) == (4, 1), said
        assert f"it requires a client's certificate, and {problem}" in said


def test_a_certificate_that_is_not_to_be_trusted_is_told_in_a_line(tmp_path: Path) -> None:
    authority, wrong = Authority(tmp_path, "authority"), Authority(tmp_path, "wrong")
    expired = authority.sign("expired", valid=-DAY)

    for endpoint_settings, ca, why in (
        (guarded(authority.sign("server")), wrong.path, "unable to get local issuer certificate"),
        (guarded(expired), authority.path, "certificate has expired"),
    ):
        code, said = joined(tmp_path, endpoint_settings, "--ca", ca)
        assert (code, len(said.splitlines())) == (4, 1), said
        assert f"its certificate is not accepted ({why})" in said


def test_a_client_without_tls_is_told_that_the_server_speaks_it(tmp_path: Path) -> None:
    code, said = joined(tmp_path, guarded(Authority(tmp_path, "authority").sign("server")))

    assert (code, len(said.splitlines())) == (4, 1), said
    assert "it uses TLS; name its authority with --ca or WILDSCAV_CA" in said


def test_files_that_are_no_certificates_are_named(tmp_path: Path) -> None:
    authority = Authority(tmp_path, "authority")
    one, other = authority.sign("one"), authority.sign("other")
    nonsense, missing = tmp_path / "nonsense.pem", str(tmp_path / "missing.pem")
    nonsense.write_text("no certificate")

    for files, why in (
        (Certificate(missing, str(one.key)), "missing.pem: No such file"),
        (Certificate(str(one.cert), str(other.key)), "not a certificate and its key: key values mismatch"),
        (Certificate(str(nonsense), str(one.key)), "not a certificate and its key"),
        (Certificate(str(one.cert), str(one.key), str(nonsense)), "nonsense.pem contains no certificate"),
    ):
        with pytest.raises(UserError, match=why) as caught:
            files.context()
        assert caught.value.exit_code == 2
    for options, why in (
        (("--ca", missing), "missing.pem: No such file"),
        (("--ca", nonsense), "not certificates and a key in PEM"),
        (("--ca", authority.path, "--cert", one.cert), "WILDSCAV_CERT and WILDSCAV_KEY belong together"),
        (("--cert", one.cert, "--key", one.key), "WILDSCAV_CERT needs WILDSCAV_CA"),
    ):
        code, said = joined(tmp_path, EndpointSettings(), *options)
        assert (code, len(said.splitlines())) == (2, 1), said
        assert why in said


@pytest.mark.parametrize("address", ["0.0.0.0:0", "[::]:0"])
@with_server
async def test_without_tls_no_other_machine_is_let_in_unless_it_is_said(served: Served, address: str) -> None:
    for server in (MatchServer(), SharedServer(1, organizer_token="correct horse")):  # noqa: S106
        with pytest.raises(UserError, match=r"can be reached from other machines.*--tls-cert.*--insecure"):
            await server.start([address])
        await server.stop()
    server = MatchServer(endpoint_settings=EndpointSettings(insecure=True))
    await server.start([address])
    await server.stop()


@pytest.mark.slow
def test_organizers_and_seats_of_a_shared_server_speak_tls(tmp_path: Path) -> None:
    authority = Authority(tmp_path, "authority")
    own = authority.sign("server")

    async def play() -> None:
        server = SharedServer(1, certificate=Certificate(str(own.cert), str(own.key)))
        (address,) = await server.start(["127.0.0.1:0"])
        secret = grpc.ssl_channel_credentials(authority.path.read_bytes())
        async with grpc.aio.secure_channel(address, secret) as channel:
            spec = small_spec(seconds=0.5).model_dump_json()
            hosted = await ArenaStub(channel).HostMatch(HostMatchRequest(spec_json=spec))
            seat = decode_seat_address(hosted, address)
            how = await ended(await start(seat, hosted.seat_tokens[0], "--ca", authority.path))
        await server.stop()
        assert how == (0, "")

    asyncio.run(play())
