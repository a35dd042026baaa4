"""What commands show in a terminal: text that cannot steer it, tables that fit, suggestions, progress."""
