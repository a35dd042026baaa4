"""The program that replaces the original's executable: ``fps.x86_64 -IP:HOST -PORT:N``.

It logs to stderr, which the client writes into its engine log; warnings and errors also go to the client's
own stderr. Exit status: 0 closed by the client; 1 the client has gone or never answered; 2 wrong arguments,
an episode that cannot be played, or a message that is too large; 3 a fault of the engine. After 2 and 3 the
client is interrupted, because it would wait forever.
"""

import logging
import os
import signal
import threading
import time
from pathlib import Path
from typing import NoReturn

from wildscav.errors import UserError, WildscavError
from wildscav.legacy.channel import Client, ClientGoneError
from wildscav.legacy.client_process import ClientStderrHandler, find_client, has_own_stderr, interrupt
from wildscav.legacy.session import Session

USAGE = "is started by the client's Game.init() as: fps.x86_64 -IP:HOST -PORT:N"

log = logging.getLogger("wildscav.legacy")
_end_once = threading.Lock()


def main(engine_folder: Path, arguments: list[str]) -> NoReturn:
    """Serve the client that the arguments name, until it closes or disappears.

    Args:
        engine_folder: The program's folder; records are written into a folder in it.
        arguments: The command line's arguments.
    """
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
    # Ctrl-C in a terminal reaches this process as well, but the client decides whether it ends the session.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    client = None
    try:
        address = read_address(arguments)
        client = find_client(int(address.rpartition(":")[2]))
        if client is not None and has_own_stderr(client):
            log.addHandler(ClientStderrHandler(client))
        serve(address, engine_folder / "records")
    except ClientGoneError as error:
        end(1, str(error))
    except WildscavError as error:
        end(2, str(error), waiting=client)
    except Exception:
        log.exception("this is a fault of the engine")
        end(3, "the client waits and cannot be sent an error: stop it", waiting=client)
    end(0)


def serve(address: str, records: Path) -> None:
    """Serve the client on an address until it closes."""
    client = Client(address)
    # This ends the process at once, even while a map is being made.
    client.on_gone(lambda: end(1, f"the client on {address} has gone"))
    log.info("connected to the client on %s", address)
    # Imported before the thread starts: two threads that import the compiler at once find it half imported.
    import wildscav_engine.simulation.match  # noqa: F401

    # Load the engine while the client waits for its user.
    threading.Thread(target=_load_engine, daemon=True).start()
    Session(client, records).run()


def read_address(arguments: list[str]) -> str:
    """Return HOST:PORT of the client.

    Raises:
        UserError: The arguments do not name one.
    """
    host, port = "127.0.0.1", ""
    for argument in arguments:
        name, _, value = argument.partition(":")
        if name == "-IP" and value:
            host = value
        elif name == "-PORT" and value.isdecimal() and 1 <= int(value) <= 65_535:
            port = value
        else:
            raise UserError(f"{argument} is not understood; the program {USAGE}", exit_code=2)
    if not port:
        raise UserError(f"no port is given; the program {USAGE}", exit_code=2)
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def end(status: int, why: str = "", waiting: int | None = None) -> NoReturn:
    """End the process and all its threads at once. If several threads call this, the first one wins.

    Args:
        status: The exit status.
        why: The message for the user.
        waiting: The client's process, if it waits for an answer that will never come; it is interrupted.
    """
    _end_once.acquire()
    if why:
        log.error("%s", why)
    logging.shutdown()
    if waiting is not None:
        interrupt(waiting)
    os._exit(status)


def _load_engine() -> None:
    from wildscav.server.hosting.precompile import precompile

    began = time.perf_counter()
    precompile(())
    log.info("the engine is ready after %.1f s", time.perf_counter() - began)
