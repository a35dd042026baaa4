"""Settings of supplies are checked when they are made."""

import pytest
from pydantic import ValidationError

from wildscav_engine.specs.supply_config import SupplyConfig


def test_a_quantity_range_must_ascend() -> None:
    with pytest.raises(ValidationError, match="outdoor_quantity"):
        SupplyConfig(outdoor_quantity=(5, 1))
