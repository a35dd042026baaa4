"""The steps from one version of a season's schema to the next."""
