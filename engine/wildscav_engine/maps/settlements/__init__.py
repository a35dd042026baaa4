"""Where houses stand: towns, hamlets, farmsteads, and the streets between them."""
