"""Tables of arrays, which kernels pass to each other in place of the arrays."""
