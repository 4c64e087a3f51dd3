"""Fly aircraft that nobody has seen, and print what the product makes of them.

``python tests/adversary N SEED``: N flights, drawn from a seed.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

for _name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.append(str(Path(__file__).parents[1] / "servers"))

from campaign import Outcome, draw_flight, go_through_doors
from shipped import serving
from table import format_table


def main(n: int, seed: int) -> None:
    outcomes = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
            client = server.connect()
            for index in range(n):
                outcomes.append(go_through_doors(client, draw_flight(seed, index)))
                _report(index, outcomes[-1])
    print(format_table(outcomes))
    print(f"{sum(len(one.faults) for one in outcomes)} refused requests")


def _report(index: int, outcome: Outcome) -> None:
    """Print progress where it does not mix with the table."""
    states = ", ".join(f"{one.method} {one.outcome}" for one in outcome.verdicts)
    print(f"{index}: {', '.join(outcome.flight.traits)}: {states}", file=sys.stderr)
    for fault in outcome.faults:
        print(f"   {fault}", file=sys.stderr)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
