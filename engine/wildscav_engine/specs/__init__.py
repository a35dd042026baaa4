"""The inputs of a match (rules, specs and actions) and its result."""
