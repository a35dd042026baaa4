"""The Python for agents without their own image: that of this machine, read-only."""

import sys
from dataclasses import dataclass
from pathlib import Path

import wildscav
from wildscav_server import leftovers

SDK = Path("/wildscav-sdk")  # the SDK's package for agents; no machine has its Python there
CODE = Path("/submission")
SOCKET = Path("/run/wildscav/match.sock")
MODEL_SOCKET = SOCKET.with_name("model.sock")
LINKED = ("/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")  # symbolic links into /usr on most systems
LOADER = ("/etc/ld.so.cache", "/etc/alternatives")  # the shared libraries, and alternative programs
NOBODY = 65534  # the user who owns nothing
ADDRESS, MODEL = f"unix:{SOCKET}", f"unix:{MODEL_SOCKET}"


@dataclass(frozen=True)
class Runtime:
    """The parts of this machine that an agent sees."""

    folders: dict[Path, Path]  # path in the sandbox: path on this machine
    links: dict[Path, str]

    def variables(self) -> dict[str, str]:
        """Return the variables that programs of this runtime need."""
        return {
            "PATH": f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin",
            "PYTHONPATH": str(SDK),
            "HOME": "/tmp",  # noqa: S108 - the agent's own folder
            "USER": "agent",
            "LANG": "C.UTF-8",
        }


def host_runtime() -> Runtime:
    """Return the parts of this machine that a Python program needs, and no others."""
    folders = {Path("/usr"): Path("/usr")}
    links: dict[Path, str] = {}
    for name in LINKED:
        path = Path(name)
        if path.is_symlink():
            links[path] = str(path.readlink())
        elif path.is_dir():
            folders[path] = path
    for path in map(Path, (*LOADER, sys.base_prefix, sys.prefix)):
        if path.exists() and not any(path.is_relative_to(parent) for parent in folders):
            folders[path] = path
    package = Path(wildscav.__file__).parent
    if any(package.is_relative_to(parent) for parent in folders):  # we are installed beside what agents see
        nothing = leftovers.own_folder() / "nothing"
        nothing.mkdir(exist_ok=True)
        folders |= dict.fromkeys(package.parent.glob("wildscav_*/"), nothing)
    folders[SDK / "wildscav"] = package
    return Runtime(folders, links)


def sockets(address: str, model: str | None) -> dict[Path, Path]:
    """Return the sockets that an agent gets, by their path in the sandbox: the match's, and the model's."""
    addresses = {SOCKET: address} | ({} if model is None else {MODEL_SOCKET: model})
    return {there: socket_path(one) for there, one in addresses.items()}


def socket_path(address: str) -> Path:
    """Return the path of a unix socket's address; ValueError if it is of another kind."""
    if not address.startswith("unix:"):
        raise ValueError(f"address is {address!r}: a sandboxed agent has no network, only a unix socket")
    return Path(address.removeprefix("unix:").removeprefix("//"))
