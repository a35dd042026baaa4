"""The folder that a script of the original's client is pointed at: its engine and its maps."""

import os
import shlex
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path

from wildscav.legacy.map_files import is_written, write_map
from wildscav.system.worker_processes import become_worker, starting_workers

PROGRAM = "fps.x86_64"
HOME = Path(__file__).parents[2]  # the folder that holds the package of Wildscav
# A shell script that starts Python with itself: paths of interpreters may be too long for a first line.
LAUNCHER = """\
#!/bin/sh
''':'
exec {python} -I "$0" "$@"
'''
# The engine of Wildscav in place of the original game's. It runs in an environment of its own, whatever the
# client has in PYTHONPATH.
import sys
from pathlib import Path

for root in {roots}:
    if root not in sys.path:
        sys.path.insert(0, root)

from wildscav.legacy.program import main

main(Path(__file__).parent, sys.argv[1:])
"""


def install_engine(folder: Path) -> Path:
    """Write the program that the client starts into a folder, and return its path.

    Raises:
        OSError: It cannot be written.
    """
    import wildscav_engine
    from wildscav_engine.storage.files import write_whole

    # Where this code lies, in case that its environment alone does not lead to it.
    roots = [str(HOME), str(Path(wildscav_engine.__path__[0]).parent)]
    text = LAUNCHER.format(python=shlex.quote(sys.executable), roots=roots)
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / PROGRAM
    write_whole(program, text.encode())
    program.chmod(0o755)
    return program


def missing_maps(ids: list[int], folder: Path) -> list[int]:
    """Return which maps a folder has not, or not as this engine makes them."""
    return [map_id for map_id in ids if not is_written(map_id, folder)]


def install_maps(ids: list[int], folder: Path, workers: int) -> Iterator[int]:
    """Write maps into a folder, several at a time.

    Args:
        ids: Which ones.
        folder: Where.
        workers: How many processes make them.

    Yields:
        The id of each map that is written.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not ids:
        return
    # New processes, not copies of this one, in which kernels may have run.
    count, spawn = min(workers, len(ids)), get_context("spawn")
    with ProcessPoolExecutor(count, spawn, become_worker, (os.getpid(),)) as pool:
        with starting_workers():
            jobs = {pool.submit(write_map, map_id, folder): map_id for map_id in ids}
        try:
            for job in as_completed(jobs):
                job.result()
                yield jobs[job]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
