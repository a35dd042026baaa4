"""The sites of houses: towns, hamlets, farmsteads, and the streets between them."""
