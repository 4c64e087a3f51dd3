"""Print the OpenAPI description of the REST API, for the generator of the frontend's types."""

from __future__ import annotations

import json
import sys
from typing import Any

from flexsid.api.app import create_app
from flexsid.settings import Settings


def main() -> None:
    """Write OpenAPI JSON to standard output, stable from run to run."""
    described = _strip_examples(create_app(Settings()).openapi())
    json.dump(described, sys.stdout, indent=2, ensure_ascii=False)
    sys.stdout.write("\n")


def _strip_examples(part: Any) -> Any:
    """Return the description without examples, which the types do not use."""
    if isinstance(part, list):
        return [_strip_examples(item) for item in part]
    if not isinstance(part, dict):
        return part
    without = {"example"} if "schema" in part else set()
    return {name: _strip_examples(item) for name, item in part.items() if name not in without}


if __name__ == "__main__":
    main()
