"""The program that replaces the original's executable: ``fps.x86_64 -IP:HOST -PORT:N``.

It logs to stderr, which the client writes into its engine log; warnings and errors also go to the client's
own stderr. Exit status: 0 closed by the client; 1 the client has gone or never answered; 2 wrong arguments,
an episode that cannot be played, or a message that is too large; 3 a fault of the engine. After 2 and 3 the
client is interrupted, because it would wait forever.
"""

import logging
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from wildscav.errors import UserError, WildscavError
from wildscav_legacy.channel import Client, ClientGoneError
from wildscav_legacy.session import Session

USAGE = "is started by the client's Game.init() as: fps.x86_64 -IP:HOST -PORT:N"

log = logging.getLogger("wildscav_legacy")
_end_once = threading.Lock()
LISTENING = "0A"  # the state in Linux's tables of sockets
TABLES = ("tcp", "tcp6")


def main(engine_folder: Path, arguments: list[str]) -> NoReturn:
    """Serve the client that the arguments name, until it is gone; records go into the engine's folder."""
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
    """Return HOST:PORT of the client, or raise a UserError if the arguments do not name one."""
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
    from wildscav_server.hosting.precompile import precompile

    began = time.perf_counter()
    precompile(())
    log.info("the engine is ready after %.1f s", time.perf_counter() - began)


class ClientStderrHandler(logging.Handler):
    """Writes warnings and errors to the stderr of another process, each text once.

    The original's protocol has no messages for errors, and the client writes its engine's output to a file
    or discards it. So they are also written to the client's own stderr, and a client that would wait forever
    is interrupted as by Ctrl-C. Both are done only if it is certain which process the client is.
    """

    def __init__(self, process: int) -> None:
        """Write to the stderr of a process."""
        super().__init__(logging.WARNING)
        self._path = Path(f"/proc/{process}/fd/2")
        self._written: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record. Errors in writing are ignored, because the client may have closed its stderr."""
        text = record.getMessage()
        if text in self._written:
            return
        self._written.add(text)
        with suppress(OSError), self._path.open("a", encoding="utf-8", errors="backslashreplace") as file:
            file.write(f"wildscav: {record.levelname.lower()}: {text}\n")


def find_client(port: int) -> int | None:
    """Return the id of the parent process if it listens on a port, else None; known on Linux only."""
    parent = os.getppid()
    with suppress(OSError):
        files = {str(each.readlink()) for each in Path(f"/proc/{parent}/fd").iterdir()}
        if files & {f"socket:[{inode}]" for inode in _listeners(port)}:
            return parent
    return None


def has_own_stderr(process: int) -> bool:
    """Return whether a process has a different stderr from this one."""
    with suppress(OSError):
        other = Path(f"/proc/{process}/fd/2").stat()
        return not os.path.samestat(other, os.fstat(sys.stderr.fileno()))
    return False


def interrupt(process: int) -> None:
    """Interrupt a process, as Ctrl-C does."""
    with suppress(OSError):
        os.kill(process, signal.SIGINT)


def _listeners(port: int) -> set[str]:
    """Return the inodes of the sockets that listen on a port."""
    found = set()
    for table in TABLES:
        with suppress(OSError):
            for line in Path(f"/proc/self/net/{table}").read_text().splitlines()[1:]:
                fields = line.split()
                if fields[3] == LISTENING and int(fields[1].rpartition(":")[2], 16) == port:
                    found.add(fields[9])
    return found
