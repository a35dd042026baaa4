"""The output folder of an evaluation: whose it is, what is kept in it, and in which form."""
