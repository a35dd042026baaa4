"""What a browser needs to draw a match in 3D: a file of its map, and a document of what happened in it."""
