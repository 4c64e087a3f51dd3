"""The description of the interface, with its examples."""
