"""Lets a language model play a seat of words, through any server that speaks OpenAI's chat protocol."""
