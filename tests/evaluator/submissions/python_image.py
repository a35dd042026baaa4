"""An image with this machine's Python, for Dockerfiles to build on where no registry is asked."""

import io
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
from collections.abc import Iterator
from pathlib import Path

from wildscav_evaluator.sandbox.agents.host_python import LINKED
from wildscav_evaluator.sandbox.containers.container_engine import ContainerEngine, call

NAME = f"localhost/wildscav/test-python-{os.getpid()}"
VERSION = f"python{sys.version_info.major}.{sys.version_info.minor}"
PROGRAMS = ("sh", "cat", "chown", "mkdir", "rm")  # that Dockerfiles use
# What packages from elsewhere expect of a system, beside what Python needs itself.
LIBRARIES = ("libstdc++.so.6", "libgcc_s.so.1", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1")
# Of pip, and where Debian's Python has the wheel of it.
SETTINGS = ("/etc/pip.conf", "/etc/ssl/certs/ca-certificates.crt", "/usr/share/python-wheels")
PASSED_ON = re.compile(r"PIP_\w+|(?:https?|no)_proxy", re.IGNORECASE)
LEFT_OUT = re.compile(r"(__pycache__|(site|dist)-packages|test|idlelib|tkinter|config-.*)$")


def python_image(engine: ContainerEngine, name: str = NAME) -> str:
    """Make an image with this machine's Python, pip's settings, and a shell; return its name.

    Tests of several files run side by side, so each process has an image of its own, which its tests remove.
    """
    changes = [f"ENV {name}={value}" for name, value in os.environ.items() if PASSED_ON.fullmatch(name)]
    options = [word for change in changes for word in ("--change", change)]
    made = call(engine, "import", *options, "-", name, content=_system())
    assert made.returncode == 0, made.stderr
    return name


def _system() -> bytes:
    """Return a root folder as a tar archive."""
    content = io.BytesIO()
    executable = Path(os.path.realpath(sys.executable))
    home = Path("/usr" if sys.base_prefix == "/usr" else "/usr/local")
    with tarfile.open(fileobj=content, mode="w") as archive:
        for name in (*LINKED, *SETTINGS):
            if Path(name).exists():
                archive.add(name)
        archive.add(sysconfig.get_path("stdlib"), arcname=home / "lib" / VERSION, filter=_wanted)
        archive.add(executable, arcname=home / "bin" / VERSION)
        _add(archive, tarfile.SYMTYPE, home / "bin" / "python3", target=VERSION)
        _add(archive, tarfile.DIRTYPE, Path("/tmp"))  # noqa: S108
        programs = [Path(found) for name in PROGRAMS if (found := shutil.which(name))]
        for path in {*programs, *_libraries(executable, *programs)}:
            # Under its own name, in the folder that it really is in.
            archive.add(path.resolve(), arcname=path.parent.resolve() / path.name)
    return content.getvalue()


def _add(archive: tarfile.TarFile, kind: bytes, path: Path, target: str = "") -> None:
    entry = tarfile.TarInfo(str(path))
    entry.type, entry.linkname, entry.mode = kind, target, 0o1777
    archive.addfile(entry)


def _wanted(entry: tarfile.TarInfo) -> tarfile.TarInfo | None:
    return None if LEFT_OUT.search(entry.name) else entry


def _libraries(*programs: Path) -> Iterator[Path]:
    """Yield the shared libraries of programs, of Python's modules, and of common packages."""
    modules = Path(sysconfig.get_path("stdlib"), "lib-dynload").glob("*.so")
    listed = subprocess.run(["ldd", *programs, *modules], capture_output=True, text=True, check=False).stdout
    # "libz.so.1 => /lib/x86_64-linux-gnu/libz.so.1 (0x…)", or the loader's path alone
    needed = {Path(path) for path in re.findall(r"(/\S+) \(0x", listed)}
    yield from needed
    folder = next(path.parent for path in needed if path.name == "libc.so.6")
    yield from (folder / name for name in LIBRARIES if (folder / name).exists())
