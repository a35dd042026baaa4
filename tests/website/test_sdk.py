"""The reference of the SDK has all that an agent may import, and says something about every field."""

import importlib
import inspect

import wildscav
import wildscav.policy
from wildscav_website import sdk


def test_all_that_an_agent_may_import_is_on_it() -> None:
    assert set(sdk.MODULES["wildscav"]) == set(wildscav.__all__) - {"__version__"}
    assert set(sdk.MODULES["wildscav.policy"]) == set(wildscav.policy.__all__)


def test_every_field_has_a_meaning() -> None:
    described = 0
    for module, names in sdk.MODULES.items():
        for name in names:
            thing = getattr(importlib.import_module(module), name)
            for field in sdk.fields_of(thing) if inspect.isclass(thing) else ():
                assert field.meaning, f"{name}.{field.name}: write what it means behind it"
                described += 1
    assert described > 60
