"""Looking at worlds and matches: the commands that show, draw, film, replay and verify them."""
