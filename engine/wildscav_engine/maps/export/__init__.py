"""Maps as meshes and as files for other programs."""
