"""The adapter to OpenEnv, which is experimental: seats as environments, their server and its client."""
