"""What people and programs are shown: documents made from the database, for the API and for pages alike."""
