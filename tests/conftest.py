"""What all tests share."""

from hypothesis import settings

# The first call of a kernel may compile it, so no single example has a deadline. The same examples are
# drawn each time, so that a run tells about the code and not about luck.
settings.register_profile("wildscav", deadline=None, derandomize=True)
settings.load_profile("wildscav")
