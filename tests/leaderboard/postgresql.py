"""A PostgreSQL server for tests, in a temporary folder and a process of its own."""

import os
import pwd
import secrets
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import create_engine, text

USER = "postgres"  # of Debian's package: the server refuses to run as root
ROOM = 4 << 30  # bytes: a database takes 10 MB
PATIENCE = 600  # s, of a busy machine: a server has taken 7 s to be made


def programs() -> Path | None:
    """Return the folder of the newest server's programs; None if there is none."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: int(path.parts[4]))
    if found:
        return found[-1].parent
    there = shutil.which("initdb")
    return None if there is None else Path(there).parent


def missing() -> str:
    """Return why there can be no server; an empty text if there can."""
    if programs() is None:
        return "PostgreSQL is not installed"
    if os.getuid() == 0 and not any(user.pw_name == USER for user in pwd.getpwall()):
        return f"PostgreSQL does not run as root, and there is no user {USER}"
    return ""


class PostgreSQL:
    """A server that listens on a socket in its own folder."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._programs = folder, programs()
        self._data = folder / "data"
        self._run("initdb", "--auth=trust", f"--username={USER}", "--no-sync", str(self._data))

    def _run(self, program: str, *arguments: str) -> None:
        assert self._programs is not None
        command = [str(self._programs / program), *arguments]
        if os.getuid() == 0:
            command = ["runuser", "-u", USER, "--", *command]
        subprocess.run(command, check=True, cwd=self._folder, stdout=subprocess.DEVNULL, timeout=PATIENCE)

    def start(self) -> None:
        """Start the server, and wait until it answers."""
        quick = "-c fsync=off -c autovacuum=off"  # which would keep a template from being copied
        options = f"-c listen_addresses= -c unix_socket_directories={self._folder} {quick}"
        folder = f"-D{self._data}", f"-l{self._folder / 'log'}"
        self._run("pg_ctl", "start", f"-wt{PATIENCE}", f"-o{options}", *folder)

    def stop(self, mode: str = "fast") -> None:
        """Stop the server; ``immediate`` is a crash."""
        self._run("pg_ctl", "stop", "-w", f"-D{self._data}", f"-m{mode}")

    def new_database(self, template: str = "template0") -> str:
        """Make a database, which is empty or a copy of one that nobody uses, and return its URL."""
        name = f"season_{secrets.token_hex(4)}"
        admin = create_engine(self._url("postgres"), isolation_level="AUTOCOMMIT")
        with admin.connect() as connection:
            connection.execute(text(f"CREATE DATABASE {name} TEMPLATE {template}"))
        admin.dispose()
        return self._url(name)

    def _url(self, name: str) -> str:
        return f"postgresql+psycopg://{USER}@/{name}?host={self._folder}"


def _in_memory() -> str | None:
    """Return a folder in memory if it has room: some disks take a minute to delete hundreds of databases."""
    folder = "/dev/shm"  # noqa: S108
    return folder if Path(folder).is_dir() and shutil.disk_usage(folder).free > ROOM else None


@contextmanager
def postgresql_server() -> Iterator[PostgreSQL]:
    """Yield a server that runs, and remove everything of it at the end."""
    folder = Path(tempfile.mkdtemp(prefix="pg-", dir=_in_memory()))
    try:
        if os.getuid() == 0:
            shutil.chown(folder, USER)
        server = PostgreSQL(folder)
        server.start()
        try:
            yield server
        finally:
            server.stop("immediate")
    finally:
        shutil.rmtree(folder, ignore_errors=True)
