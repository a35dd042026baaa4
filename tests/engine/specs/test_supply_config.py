"""Settings of supplies are checked when they are made."""

import pytest
from pydantic import ValidationError

from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig


@pytest.mark.parametrize(
    ("config", "name"),
    [(SupplyConfig, "outdoor_quantity"), (SupplyConfig, "indoor_quantity"), (HotSpot, "quantity")],
)
def test_a_quantity_range_must_ascend(config: type[Spec], name: str) -> None:
    with pytest.raises(ValidationError, match=rf"{name}\n.*{name} is \(5, 1\): the first number must not be"):
        config(**{name: (5, 1)})
