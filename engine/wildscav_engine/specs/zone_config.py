"""The schedule of the safe zone."""

from typing import Annotated

from pydantic import Field

from wildscav_engine.specs.base import Spec


class ZonePhase(Spec):
    """One phase of the safe zone: it waits, then shrinks to a smaller circle inside the current one."""

    wait: Annotated[float, Field(ge=0, le=86_400)]  # s before the zone begins to shrink
    shrink: Annotated[float, Field(gt=0, le=86_400)]  # s that shrinking takes
    share: Annotated[float, Field(ge=0, le=1)]  # the new radius divided by the old one
    damage: Annotated[int, Field(ge=0, le=10_000)]  # hp per second outside, from the start of the phase


class ZoneConfig(Spec):
    """The schedule of the safe zone, which starts as the circle around the whole map."""

    phases: Annotated[tuple[ZonePhase, ...], Field(max_length=16)] = ()
