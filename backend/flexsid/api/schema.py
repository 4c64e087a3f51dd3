"""Print the description of the REST interface, for the generator of the page's types."""

from __future__ import annotations

import json
import sys

from flexsid.api.app import create_app
from flexsid.settings import Settings


def main() -> None:
    """Write OpenAPI JSON to standard output, stable from run to run."""
    json.dump(create_app(Settings()).openapi(), sys.stdout, indent=2, ensure_ascii=False)
    sys.stdout.write("\n")


if __name__ == "__main__":
    main()
