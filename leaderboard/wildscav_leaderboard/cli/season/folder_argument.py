"""The argument that names a season's folder."""

from pathlib import Path
from typing import Annotated

import typer

SeasonFolder = Annotated[Path, typer.Argument(help="The season's folder.", metavar="DIR", show_default=False)]
