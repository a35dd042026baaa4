"""How matches begin: from their specs and maps to the state before the first step."""
