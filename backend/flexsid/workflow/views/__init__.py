"""Views: data of figures, read from the database."""
