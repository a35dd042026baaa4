"""Export of maps as meshes and files for other programs."""
