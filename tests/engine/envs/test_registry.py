"""When Gymnasium and PettingZoo know the ids of the environments."""

import subprocess
import sys

import pytest

KNOWN = "gymnasium.spec('WildScav/Battle-v1'); pettingzoo.parallel_registry['wildscav/battle-v0']"


def run(code: str) -> None:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "code",
    [
        f"import gymnasium, pettingzoo, wildscav_engine; {KNOWN}",
        # The engine imports no library for several agents, and watches no imports.
        (
            "import sys, wildscav_engine.simulation.match, wildscav_engine.sensors\n"
            "assert 'pettingzoo' not in sys.modules\n"
            "assert not [one for one in sys.meta_path if type(one).__module__.startswith('wildscav')]\n"
            f"import gymnasium, wildscav_engine.envs.parallel, pettingzoo; {KNOWN}"
        ),
        "import gymnasium; gymnasium.make('wildscav_engine:WildScav/Battle-v1')",
    ],
)
def test_ids_are_known_once_the_engine_or_its_environments_are_imported(code: str) -> None:
    run(code)


def test_a_star_import_works_without_optional_libraries() -> None:
    run(
        "import sys\n"
        "missing = {'stable_baselines3', 'pettingzoo'}\n"
        "sys.modules |= dict.fromkeys(missing)\n"  # as Python's own tests make a module missing
        "from importlib import util\n"
        "real = util.find_spec\n"
        "util.find_spec = lambda name, *rest: None if name in missing else real(name, *rest)\n"
        "from wildscav_engine.envs import *\n"
        "assert SingleEnv and VectorArena\n"
        "assert not {'StableVector', 'parallel_env', 'aec_env'} & set(globals())\n"
    )
