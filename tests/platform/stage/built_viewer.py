"""A viewer that is built, for tests that do not run it: a fixture."""

from pathlib import Path

import pytest

from wildscav_stage import viewer_files

SCRIPT, STYLE = 'console.log("</script><!-- é");\n', ".player::after { content: '</style>'; }\n"

LEGAL = "MIT --> License"


@pytest.fixture
def viewer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a small viewer, in place of the real one."""
    folder = tmp_path / "viewer"
    folder.mkdir()
    (folder / "viewer.js").write_text(SCRIPT)
    (folder / "viewer.css").write_text(STYLE)
    (folder / "viewer.js.LEGAL.txt").write_text(LEGAL)
    monkeypatch.setattr(viewer_files, "FOLDER", folder)
    return folder
