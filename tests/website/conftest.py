"""A small viewer."""

from tests.platform.stage.built_viewer import viewer

__all__ = ["viewer"]
