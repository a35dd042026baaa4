"""The base of all JSON files in an output folder, and of other documents.

A folder may come from an untrusted source, so its files are read with limits. A small file takes little
memory. A large one is first read in a process with limits, and here only if it fits into those.
"""

import json
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    GetJsonSchemaHandler,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core.core_schema import CoreSchema

from wildscav.errors import UserError
from wildscav.system.limited_process import LimitExceededError, call_limited
from wildscav.terminal.console import ascii_json
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.files import read_limited, write_whole

LARGEST = 64 << 20  # bytes of a file
MEMORY = 512 << 20  # bytes of memory that reading a large file may take
PROCESSOR_TIME = 60  # s that it may take; the ledger of 20,000 matches takes 33
SMALL = 256 << 10  # bytes of a file that is read without a trial


class Document(BaseModel):
    """Base of models that may have fields in common with what they describe."""

    @classmethod
    def about(cls, source: object, **others: Any) -> Self:
        """Return a document of what something has of its fields, and of the others that are given."""
        names = [name for name in cls.model_fields if name not in others and hasattr(source, name)]
        return cls.model_validate({name: getattr(source, name) for name in names} | others)


class FileModel(Document):
    """Base of the models of such a file and its parts."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a file; FileModelError if it is too large, or not of this kind."""
        return cls.parse(read_after_trial(path, f"{cls.__module__}:{cls.__qualname__}.try_file"))

    @classmethod
    def try_file(cls, path: str) -> None:
        """Read a file in the calling process, and discard its content."""
        cls.parse(read_limited(Path(path), LARGEST))

    @classmethod
    def parse(cls, content: bytes) -> Self:
        """Parse some bytes of JSON as this model; FileModelError if they are not valid."""
        try:
            return cls.model_validate_json(content)
        except ValidationError as error:
            raise FileModelError(one_line(error)) from None

    def as_json(self) -> Any:
        """Return this as values of JSON's types."""
        return json.loads(self.model_dump_json())

    def write(self, path: Path) -> Path:
        """Write this as a file, whole or not at all, and return its path."""
        write_whole(path, ascii_json(self.model_dump_json(indent=1)).encode("ascii") + b"\n")
        return path


class WithOptionalFields(FileModel):
    """Base of models whose files omit some fields that are None, so that files without them do not change."""

    omitted: ClassVar[tuple[str, ...]] = ()  # the names of these fields

    @model_serializer(mode="wrap")
    def _omit(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = serialize(self)
        return {
            name: value
            for name, value in fields.items()
            if name not in self.omitted or getattr(self, name) is not None
        }

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe the fields: by its serializer, a document could have any."""
        return handler({name: part for name, part in schema.items() if name != "serialization"})


class FileModelError(UserError):
    """A file is not valid; the message is one line that says why, without the file's name."""


def read_after_trial(path: Path, trial: str) -> bytes:
    """Return the content of a file; try to read a large one in a process with limits first.

    ``trial`` names the function that reads the file there as the caller will, as for ``call_limited``; it is
    called with the path, and its module is imported before memory is counted. FileModelError if a large file
    cannot be read, or takes too much time or memory.
    """
    large = path.stat().st_size > SMALL
    if large:
        try:
            call_limited(trial, str(path), memory=MEMORY, processor_time=PROCESSOR_TIME)
        except LimitExceededError as error:
            raise FileModelError(f"reading it would take too many resources: {error}") from None
        except UserError as error:
            raise FileModelError(str(error)) from None
    return read_limited(path, LARGEST if large else SMALL)
