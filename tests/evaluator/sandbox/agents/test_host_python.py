"""What agents see of this machine's Python, however Wildscav is installed in it."""

import shutil
import site
import subprocess
import venv
from pathlib import Path

import pytest
from tests.evaluator.sandbox.available import missing

import wildscav
import wildscav_engine
import wildscav_evaluator
import wildscav_server

START = """
import asyncio, socket, sys
from pathlib import Path
from wildscav_evaluator.sandbox import SANDBOXES, Launch

async def main(name, folder):
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(folder / "match.sock"))
        address, command = f"unix:{folder}/match.sock", ("python", "agent.py")
        launch = Launch(folder / "code", "", address, "token", folder / "log", command=command)
        agent = await SANDBOXES[name].start(launch)
        await agent.ended()
        await agent.stop()

asyncio.run(main(sys.argv[1], Path(sys.argv[2])))
"""
AGENT = """
try:
    from wildscav_engine.storage import files
except ImportError as error:
    print(error)
else:
    print(files.__file__)
"""


@pytest.mark.parametrize("name", ["bubblewrap", pytest.param("oci", marks=pytest.mark.slow)])
def test_agents_cannot_import_the_engine_that_is_installed_beside_the_sdk(tmp_path: Path, name: str) -> None:
    if why := missing(name):
        pytest.skip(why)
    venv.create(tmp_path / "venv")
    python, (packages,) = (
        tmp_path / "venv" / "bin" / "python",
        (tmp_path / "venv").glob("lib/*/site-packages"),
    )
    shutil.copytree(Path(wildscav_engine.__file__).parent, packages / "wildscav_engine")
    (packages / "wildscav").symlink_to(Path(wildscav.__file__).parent)
    shutil.copytree(Path(wildscav_server.__file__).parent, packages / "wildscav_server")
    others = [*site.getsitepackages(), str(Path(wildscav_evaluator.__file__).parents[1])]
    (packages / "others.pth").write_text("\n".join(others))
    (tmp_path / "code").mkdir()
    (tmp_path / "code" / "agent.py").write_text(AGENT)
    control = subprocess.check_output([python, "-c", AGENT], text=True, env={})
    assert control == f"{packages}/wildscav_engine/storage/files.py\n"

    subprocess.run([python, "-c", START, name, tmp_path], check=True)

    assert (tmp_path / "log").read_text() == "No module named 'wildscav_engine.storage'\n"
