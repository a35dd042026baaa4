"""The program in place of the original's executable: ``fps.x86_64 -IP:HOST -PORT:N``.

All that it says goes to stderr, which the client writes into its engine log; warnings and errors go to the
client's own stderr, too. Exit status: 0 closed by the client, 1 the client has gone or was never there, 2
wrong arguments or an episode that cannot be played or told. A client that would wait forever for that is
interrupted.
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
from wildscav.legacy.client_process import UserHandler, find_client, has_own_stderr, interrupt
from wildscav.legacy.session import Session

USAGE = "is started by the client's Game.init() as: fps.x86_64 -IP:HOST -PORT:N"

log = logging.getLogger("wildscav.legacy")
_end_once = threading.Lock()


def main(engine_folder: Path, arguments: list[str]) -> NoReturn:
    """Serve the client that the arguments name, until it closes or goes.

    Args:
        engine_folder: Where the program lies; records are written beside it.
        arguments: Of the command line.
    """
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
    # Ctrl-C in a terminal reaches us, too: whether it ends the session is for the client to say.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    client = None
    try:
        address = read_address(arguments)
        client = find_client(int(address.rpartition(":")[2]))
        if client is not None and has_own_stderr(client):
            log.addHandler(UserHandler(client))
        serve(address, engine_folder / "records")
    except ClientGoneError as error:
        end(1, str(error))
    except WildscavError as error:
        end(2, str(error), waiting=client)
    except Exception:
        log.exception("this is a fault of the engine")
        end(3, "the client cannot be told and waits: stop it", waiting=client)
    end(0)


def serve(address: str, records: Path) -> None:
    """Serve the client on an address until it closes."""
    client = Client(address)
    # At once, whatever is being done: a map may take long to make.
    client.when_gone(lambda: end(1, f"the client on {address} has gone"))
    log.info("connected to the client on %s", address)
    # Here, because two threads that import the compiler at once find it half imported.
    import wildscav_engine.simulation.match  # noqa: F401

    # While the client waits for its user.
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
    """End the process at once, other threads and all; the first to say why is heard.

    Args:
        status: Of the exit.
        why: What the user is to read.
        waiting: The client's process, if it waits for an answer that will never come: it is interrupted.
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
