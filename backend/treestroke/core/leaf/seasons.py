"""The seasons: colour and number of leaves."""

SEASONS = ("spring", "summer", "autumn", "bare")
