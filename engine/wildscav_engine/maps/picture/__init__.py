"""Pictures of maps from above. Pillow is imported only when one is made."""

from wildscav_engine.maps.picture.draw import draw_map

__all__ = ["draw_map"]
