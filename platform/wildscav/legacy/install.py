"""Installation of the engine and the maps that scripts for the original's client use."""

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
HOME = Path(__file__).parents[2]  # the folder that contains the package wildscav
# A shell script that runs itself with Python, because the interpreter's path may be too long for a "#!" line.
LAUNCHER = """\
#!/bin/sh
''':'
exec {python} -I "$0" "$@"
'''
# The engine of Wildscav in place of the original game's. It runs in its own Python environment, independent
# of the client's PYTHONPATH.
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

    # The folders of this code, which may not be on the default path of its Python environment.
    roots = [str(HOME), str(Path(wildscav_engine.__path__[0]).parent)]
    text = LAUNCHER.format(python=shlex.quote(sys.executable), roots=roots)
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / PROGRAM
    write_whole(program, text.encode())
    program.chmod(0o755)
    return program


def missing_maps(ids: list[int], folder: Path) -> list[int]:
    """Return the ids of maps that a folder lacks, or that another version of the generator made."""
    return [map_id for map_id in ids if not is_written(map_id, folder)]


def install_maps(ids: list[int], folder: Path, workers: int) -> Iterator[int]:
    """Write maps into a folder, several at a time.

    Args:
        ids: Ids of the maps.
        folder: The folder.
        workers: Number of processes.

    Yields:
        The id of each map once it is written.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not ids:
        return
    # Spawned, not forked, because kernels may have run in this process.
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
