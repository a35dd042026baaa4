"""People who play in the browser: their table, what their pages may know, and what they send."""
