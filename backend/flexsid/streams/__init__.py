"""Streams: receivers of samples, processes that identify while the aircraft flies."""
