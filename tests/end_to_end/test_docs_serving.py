"""What the page of the shared server says is true: its commands and its code run as they stand."""

import shutil
import ssl
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from tests.end_to_end.pages import blocks, run_code, run_line
from tests.ports import free_ports

from wildscav_server.hosting.precompile import precompile

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "serving.md"


@pytest.mark.slow
def test_the_commands_and_the_code_of_the_page_play_a_match(tmp_path: Path) -> None:
    precompile()
    port = str(free_ports(3))
    (console,), (code,) = (
        [block.replace("50051", port) for block in blocks(PAGE, kind)] for kind in ("console", "python")
    )
    make_token, serve = console.strip().splitlines()
    shutil.copytree(ROOT / "submissions" / "homing", tmp_path / "submissions" / "homing")
    subprocess.run(make_token.replace("python", sys.executable, 1), shell=True, cwd=tmp_path, check=True)  # noqa: S602
    command = [sys.executable, "-m", "wildscav.cli.main", *serve.split()[1:]]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        lines = [server.stdout.readline() for _ in range(3)]
        assert [line.split()[0] for line in lines] == ["listening", "worker", "worker"]
        try:
            said = run_code(code, tmp_path)
        finally:
            server.terminate()
        assert server.wait(120) == 0

    assert "success" in said or "score" in said, said
    run_line("wildscav verify match.wsr", tmp_path)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
def test_the_certificate_of_the_page_is_accepted_by_the_strictest_client(tmp_path: Path) -> None:
    make_certificate = next(block for block in blocks(PAGE, "sh") if block.startswith("openssl req"))
    subprocess.run(make_certificate, shell=True, cwd=tmp_path, check=True, capture_output=True)  # noqa: S602

    server = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    server.load_cert_chain(tmp_path / "server.pem", tmp_path / "server.key")
    client = ssl.create_default_context(cafile=tmp_path / "ca.pem")
    client.verify_flags |= ssl.VERIFY_X509_STRICT  # the default from Python 3.13 on

    assert greet(client, server, "arena.example.org") == "TLSv1.3"


def greet(client: ssl.SSLContext, server: ssl.SSLContext, host: str) -> str | None:
    """Let two ends greet each other, without a network; return the version of TLS that they agree on."""
    to_client, to_server = ssl.MemoryBIO(), ssl.MemoryBIO()
    ends = (
        client.wrap_bio(to_client, to_server, server_hostname=host),
        server.wrap_bio(to_server, to_client, server_side=True),
    )
    for _ in range(3):
        for end in ends:
            with suppress(ssl.SSLWantReadError):
                end.do_handshake()
    return ends[0].version()
