"""Certificate of a Dask cluster: ``flexsid cluster-certificate``."""

from __future__ import annotations

import argparse
from datetime import UTC, datetime
from pathlib import Path

from flexsid.cli.output import print_written_file
from flexsid.jobs.cluster_certificate import write_cluster_certificate
from flexsid.settings import Settings


def write_certificate(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write the configuration of a Dask cluster with a new key and certificate."""
    end = write_cluster_certificate(Path(arguments.file), datetime.now(UTC))
    text = f"wrote {arguments.file}, valid until {end:%Y-%m-%d}; name it by DASK_CONFIG"
    result = {"file": arguments.file, "valid_until": end.isoformat()}
    print_written_file(text, result, as_json=arguments.json)
    return 0
