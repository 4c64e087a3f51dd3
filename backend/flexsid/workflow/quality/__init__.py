"""Data quality of maneuvers and campaigns, and ground records."""
