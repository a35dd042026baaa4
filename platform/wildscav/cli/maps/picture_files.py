"""Writing pictures to files."""

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav.errors import UserError

if TYPE_CHECKING:
    from PIL.Image import Image


def format_of(path: Path) -> str:
    """Return the picture format of a file by its name."""
    formats = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP"}
    if path.suffix.lower() not in formats:
        raise UserError(f"{path} must end in one of {', '.join(formats)}", exit_code=2)
    return formats[path.suffix.lower()]


def save(picture: "Image", path: Path) -> str:
    """Write a picture in the format of its file name; no partial file is left behind.

    Returns:
        A line that says what was written, and whether it replaced another file.
    """
    replaced = ", replacing the file that was there" if path.exists() else ""
    from wildscav_engine.storage.files import write_whole

    content = BytesIO()
    picture.save(content, format_of(path), quality=90, optimize=True)
    write_whole(path, content.getvalue())
    return f"{path}: {picture.width} × {picture.height} pixels{replaced}"
