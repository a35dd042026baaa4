"""The limits on an agent's use of the machine."""

from typing import Annotated

from pydantic import BaseModel, ByteSize, ConfigDict, Field

MEBIBYTE = 1 << 20


class Limits(BaseModel):
    """The limits of one agent in one match. Sizes may be strings such as "512MiB".

    An agent's files are in memory, so those in ``/tmp`` count as memory too.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    cpus: Annotated[float, Field(ge=0.05, le=1024)] = 1.0  # cores' worth of processor time
    memory: Annotated[ByteSize, Field(ge=64 * MEBIBYTE)] = ByteSize(2048 * MEBIBYTE)  # bytes, no swap
    processes: Annotated[int, Field(ge=16, le=100_000)] = 256  # processes and threads together
    open_files: Annotated[int, Field(ge=64, le=1_000_000)] = 1024  # of each process
    tmp_size: Annotated[ByteSize, Field(ge=MEBIBYTE)] = ByteSize(256 * MEBIBYTE)  # bytes in /tmp
    output: Annotated[ByteSize, Field(ge=4096)] = ByteSize(1_000_000)  # bytes of its output that are kept
    # s, the longest time of all steps of a match: time banks are smaller if they would exceed it together.
    wall_clock: Annotated[float | None, Field(gt=0, le=604_800)] = None  # None: as budgets and banks allow


# The limits of a track's matches unless their suite sets others.
DEFAULT_LIMITS = Limits()
KEPT_ANYWHERE = {"output", "wall_clock"}  # limits that even a sandbox without isolation enforces
