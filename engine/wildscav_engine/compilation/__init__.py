"""How kernels are compiled and kept: what their code depends on, and where it is found again."""
