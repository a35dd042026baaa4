"""The implementation of ``rendering.trace``: how the rays of an image find their hits."""
