"""The colours of pictures: light, sky, water, and the grain of surfaces."""
