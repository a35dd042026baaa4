"""The site of a table: its pages, and the server of it all."""
