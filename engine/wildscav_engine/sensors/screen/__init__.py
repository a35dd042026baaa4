"""The sensor ``screen``: a picture with the display of a person over it, drawn by kernels."""
