"""The season itself: its settings, its folder, its state, announcements, and the log of privileged acts."""
