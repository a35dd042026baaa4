"""Training of agents: learners, opponents, data sets, and the export of policies as submissions."""
