"""What an agent perceives: one file and one registry line a sensor."""
