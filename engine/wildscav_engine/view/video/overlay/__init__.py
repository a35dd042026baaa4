"""What is written over the pictures of a video. Pillow is imported when something is drawn."""
