"""The server of MCP, by which language models start matches and play in them: ``wildscav mcp``."""
