"""What a campaign is made of: frozen values that are row, JSON and notebook object at once."""
