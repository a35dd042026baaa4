"""The light of the sun and the sky on surfaces, and what keeps it off."""
