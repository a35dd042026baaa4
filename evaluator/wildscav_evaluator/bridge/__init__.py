"""The bridge: plays seats over the match's socket, and serves their agents words or keys in place of it."""
