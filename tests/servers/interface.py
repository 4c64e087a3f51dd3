"""The OpenAPI description of the interface, made once in a process: it takes seconds."""

from __future__ import annotations

from flexsid.api.app import create_app
from flexsid.settings import Settings

DESCRIPTION = create_app(Settings()).openapi()
