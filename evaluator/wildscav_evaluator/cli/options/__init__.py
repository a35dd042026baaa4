"""Options and arguments that several commands share, and checks of their values."""
