"""The ground of generated maps: relief, erosion, lakes."""
