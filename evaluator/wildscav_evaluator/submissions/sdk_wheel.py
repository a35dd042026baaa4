"""The SDK as a wheel, made from the installed package, for the base of agents' images.

It contains only the package ``wildscav``, not what a match server needs in addition.
"""

import base64
import hashlib
import zipfile
from email.message import Message
from importlib.metadata import distribution
from pathlib import Path

import wildscav

TAG = "py3-none-any"
LEFT_OUT = {"__pycache__"}


def write_sdk_wheel(folder: Path) -> Path:
    """Write the wheel into a folder and return its path."""
    package = Path(wildscav.__file__).parent
    info = f"wildscav-{wildscav.__version__}.dist-info"
    content = {
        f"wildscav/{path.relative_to(package).as_posix()}": path.read_bytes()
        for path in sorted(package.rglob("*"))
        if path.is_file() and not LEFT_OUT.intersection(path.parts)
    }
    wheel_info = ("Wheel-Version: 1.0", "Generator: wildscav", "Root-Is-Purelib: true", f"Tag: {TAG}", "")
    content |= {
        f"{info}/METADATA": _metadata().encode(),
        f"{info}/WHEEL": "\n".join(wheel_info).encode(),
        f"{info}/entry_points.txt": b"[console_scripts]\nwildscav = wildscav.cli.main:main\n",
    }
    record = f"{info}/RECORD"
    lines = [f"{name},sha256={_digest(data)},{len(data)}" for name, data in content.items()]
    content[record] = "\n".join([*lines, f"{record},,", ""]).encode()
    path = folder / f"wildscav-{wildscav.__version__}-{TAG}.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in content.items():
            wheel.writestr(name, data)
    return path


def _metadata() -> str:
    """Return the metadata for pip: the version and the dependencies of the SDK, without extras."""
    known = distribution("wildscav")
    message = Message()
    message["Metadata-Version"] = "2.1"
    message["Name"] = "wildscav"
    message["Version"] = wildscav.__version__
    message["Requires-Python"] = known.metadata["Requires-Python"]
    for requirement in known.requires or ():
        if "extra ==" not in requirement:
            message["Requires-Dist"] = requirement
    return str(message)


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
