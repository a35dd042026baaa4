"""What a match is a function of: rules, specs and actions; and what comes out of it."""
