"""What a seat has at the start and after each respawn."""

from typing import Annotated, NamedTuple

from pydantic import Field

from wildscav_engine.specs.base import Spec


class Equipment(Spec):
    """The equipment of one seat at the start and after each respawn; None: as the rules say for all seats."""

    health: Annotated[int, Field(ge=1, le=10_000)] | None = None  # hp
    clip_size: Annotated[int, Field(ge=0, le=1000)] | None = None  # rounds; 0: a weapon that never fires
    spare_ammo: Annotated[int, Field(ge=0, le=100_000)] | None = None  # rounds
    shot_damage: Annotated[int, Field(ge=0, le=10_000)] | None = None  # hp per hit


class SeatEquipment(NamedTuple):
    """The complete equipment of one seat."""

    health: int  # hp
    clip_size: int  # rounds
    spare_ammo: int  # rounds
    shot_damage: int  # hp per hit
