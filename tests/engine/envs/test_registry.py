"""When Gymnasium and PettingZoo know the ids of the environments."""

import subprocess
import sys

import pytest

LATER = "import wildscav_engine, sys; assert 'gymnasium' not in sys.modules; "
# TorchRL and others look whether a library is there before they import it.
LOOK = "from importlib.util import find_spec; assert find_spec('gymnasium') and find_spec('pettingzoo'); "
KNOWN = (
    "import gymnasium, pettingzoo; assert 'WildScav/Battle-v0' in gymnasium.registry; "
    "assert 'wildscav/battle-v0' in pettingzoo.parallel_registry"
)


@pytest.mark.parametrize(
    "code",
    [
        LATER + KNOWN,
        LATER + LOOK + LOOK + KNOWN,
        "import gymnasium, pettingzoo, wildscav_engine; " + KNOWN,
    ],
    ids=["imported before", "looked for", "imported after"],
)
def test_the_ids_are_known_whatever_is_imported_first(code: str) -> None:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("missing", "names"),
    [("stable_baselines3", {"StableVector"}), ("pettingzoo", {"parallel_env", "aec_env"})],
)
def test_a_star_import_works_without_an_optional_library(missing: str, names: set[str]) -> None:
    code = (
        f"import sys; sys.modules[{missing!r}] = None\n"  # as Python's own tests make a module missing
        "from importlib import util\n"
        "real = util.find_spec\n"
        f"util.find_spec = lambda name, *rest: None if name == {missing!r} else real(name, *rest)\n"
        "from wildscav_engine.envs import *\n"
        "assert SingleEnv and VectorArena\n"
        f"assert not {names!r} & set(globals())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
