"""Images of the world: tracing the rays of cameras and shading what they hit."""
