"""The ``flexsid`` command."""
