"""Kernels are Python: without a compiler they do the same, so that they can be debugged and covered."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.engine.simulation.plain_match import report

from wildscav_engine.compilation.kernel import _argument_type, _specialize


@pytest.mark.slow
def test_matches_maps_and_environments_are_the_same_with_kernels_as_plain_python() -> None:
    script = Path(__file__).parent / "plain_match.py"
    done = subprocess.run(
        [sys.executable, str(script)],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    found = json.loads(done.stdout)
    assert found == report()
    assert len(set(found[0])) == 11  # of as many different states


def test_without_a_compiler_short_calls_take_the_same_arguments() -> None:
    add = _specialize(
        lambda numbers, more: numbers + more, [_argument_type(np.zeros(1)), _argument_type(1.0)]
    )
    assert add(np.ones(2), 2.0).tolist() == [3.0, 3.0]
    for arguments in ((np.zeros(1, np.int32), 1.0), (np.zeros((1, 1)), 1.0), ([0.0], 1.0), (np.zeros(1), 1)):
        with pytest.raises(TypeError, match="takes"):
            add(*arguments)
