"""What runs in a sandbox: an agent's process, its log, its files and its Python."""
