"""The map of a match from above, as a picture without frame or text, over which a page draws the trails."""

from io import BytesIO
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from wildscav.errors import UserError
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps import MapError, map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.picture.paint import raster
from wildscav_engine.maps.picture.top_view import Window
from wildscav_engine.record import RecordError, read_record
from wildscav_engine.specs.map_spec import MapSpec

WIDTH = 1000  # pixels
QUALITY = 82  # of WebP, 0-100
SPEC = ".json"  # ending of a file that has a MapSpec


class Placement(BaseModel):
    """Where the pixels of a picture lie in the world: x grows to the east, z to the north."""

    model_config = ConfigDict(frozen=True)

    west: float  # m, x of the left edge
    north: float  # m, z of the upper edge
    metres_per_pixel: float
    width: int  # pixels
    height: int  # pixels


def placement(game_map: GameMap, width: int = WIDTH) -> Placement:
    """Return where the pixels of the picture of a map lie.

    Args:
        game_map: The map.
        width: The width of the picture, in pixels.
    """
    west, south = game_map.world.corner
    rows, columns = game_map.world.water.shape
    return Placement(
        west=float(west),
        north=float(south + rows * CELL),
        metres_per_pixel=float(columns * CELL / width),
        width=width,
        height=round(width * rows / columns),
    )


def overview(game_map: GameMap, width: int = WIDTH) -> bytes:
    """Return the picture of a map from above, as WebP.

    Args:
        game_map: The map.
        width: Its width, in pixels.
    """
    from PIL import Image

    shown = placement(game_map, width)
    window = Window(shown.west, shown.north, shown.metres_per_pixel, shown.height, shown.width)
    content = BytesIO()
    Image.fromarray(raster(game_map, window, None)).save(content, "WEBP", quality=QUALITY, method=4)
    return content.getvalue()


def overview_of_file(path: Path) -> bytes:
    """Return the picture of the map of a record, or of a spec of a map (``.json``), as WebP.

    Raises:
        UserError: The record cannot be read, or its map not be made.
    """
    try:
        is_spec = path.suffix == SPEC
        spec = MapSpec.model_validate_json(path.read_bytes()) if is_spec else read_record(path).spec.map
        return overview(map_of(spec))
    except (RecordError, MapError) as error:
        raise UserError(str(error)) from None
