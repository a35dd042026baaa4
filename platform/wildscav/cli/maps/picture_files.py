"""How commands write pictures."""

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav.errors import UserError

if TYPE_CHECKING:
    from PIL.Image import Image


def format_of(path: Path) -> str:
    """Return the picture format that a file's name asks for."""
    formats = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP"}
    if path.suffix.lower() not in formats:
        raise UserError(f"{path} must end in one of {', '.join(formats)}", exit_code=2)
    return formats[path.suffix.lower()]


def save(picture: "Image", path: Path) -> str:
    """Write a picture as its file's name says; nothing is left half-written.

    Returns:
        A line that says what was written, and whether it took the place of another file.
    """
    replaced = ", in place of the file that was there" if path.exists() else ""
    from wildscav_engine.storage.files import write_whole

    content = BytesIO()
    picture.save(content, format_of(path), quality=90, optimize=True)
    write_whole(path, content.getvalue())
    return f"{path}: {picture.width} × {picture.height} pixels{replaced}"
