"""What learners observe and do: the columns of observations, the action modes, and their spaces."""
