"""The ``wildscav`` command."""
