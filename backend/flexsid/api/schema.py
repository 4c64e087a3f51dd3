"""Print the description of the REST interface, for the generator of the page's types."""

from __future__ import annotations

import json
import sys
from typing import Any

from flexsid.api.app import create_app
from flexsid.settings import Settings


def main() -> None:
    """Write OpenAPI JSON to standard output, stable from run to run."""
    described = _bare(create_app(Settings()).openapi())
    json.dump(described, sys.stdout, indent=2, ensure_ascii=False)
    sys.stdout.write("\n")


def _bare(part: Any) -> Any:
    """Without examples of what is sent and answered: types have no use for them."""
    if isinstance(part, list):
        return [_bare(item) for item in part]
    if not isinstance(part, dict):
        return part
    without = {"example"} if "schema" in part else set()
    return {name: _bare(item) for name, item in part.items() if name not in without}


if __name__ == "__main__":
    main()
