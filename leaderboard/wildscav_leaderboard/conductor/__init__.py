"""The conductor: moves submissions through their states, and has matches played by an executor."""
