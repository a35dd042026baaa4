"""An agent in a sandbox: its process, its log, its files and its Python."""
