"""Records: frozen dataclasses stored as rows and used in JSON and notebooks."""
