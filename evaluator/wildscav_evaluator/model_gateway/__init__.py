"""The gateway: how agents without a network ask a language model, at a price and within a budget."""
