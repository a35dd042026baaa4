"""The SDK's reference is made from the code and says something about every field."""

import importlib
import importlib.util
import inspect
from pathlib import Path
from types import ModuleType

import pytest

import wildscav
import wildscav.policy

SCRIPT = Path(__file__).parents[2] / "docs" / "sdk.py"


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("sdk_reference", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_up_to_date(script: ModuleType) -> None:
    assert script.PAGE.read_text("utf-8") == script.reference(), "make it again: python docs/sdk.py"


def test_all_that_an_agent_may_import_is_on_it(script: ModuleType) -> None:
    assert set(script.MODULES["wildscav"]) == set(wildscav.__all__) - {"__version__"}
    assert set(script.MODULES["wildscav.policy"]) == set(wildscav.policy.__all__)


def test_every_field_has_a_meaning(script: ModuleType) -> None:
    described = 0
    for module, names in script.MODULES.items():
        for name in names:
            thing = getattr(importlib.import_module(module), name)
            for field in script.fields_of(thing) if inspect.isclass(thing) else ():
                assert field.meaning, f"{name}.{field.name}: write what it means behind it"
                described += 1
    assert described > 60
