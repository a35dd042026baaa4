"""The commands of training: ``wildscav train``, ``wildscav dataset``, and policies for ``wildscav init``."""
