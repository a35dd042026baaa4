"""Output of commands: consoles that escape untrusted text, tables that fit, suggestions and progress."""
