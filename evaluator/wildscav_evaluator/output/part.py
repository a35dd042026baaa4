"""What all files of the output folder that hold JSON are made of."""

import json
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from wildscav.console import ascii_json
from wildscav_engine.files import write_whole


class Part(BaseModel):
    """Base of everything in such a file, and of the file itself."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def as_json(self) -> Any:
        """Return this as the values that JSON has."""
        return json.loads(self.model_dump_json())

    def write(self, path: Path) -> Path:
        """Write this as a file, whole or not at all, and return its path.

        Raises:
            OSError: It cannot be written.
        """
        write_whole(path, ascii_json(self.model_dump_json(indent=1)).encode("ascii") + b"\n")
        return path
