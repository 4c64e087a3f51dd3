"""Workers of this computer: what they are sent, and their memory limit."""

from __future__ import annotations

import pickle
import subprocess
import sys

import pytest
from waiting import PATIENCE_S

from flexsid.jobs.local import LocalWorkers
from flexsid.jobs.worker import LoadKinds

FIRST_PRODUCT = """
from flexsid.jobs.worker import _limit_memory
with _limit_memory({memory_mb}):
    import numpy as np
    import scipy.linalg
    matrix = np.eye(200)
    scipy.linalg.cho_factor(np.linalg.solve(matrix, matrix))
print("done")
"""


@pytest.mark.parametrize("memory_mb", [24, 64])
def test_the_first_matrix_product_does_not_hang_at_the_memory_limit(memory_mb: int) -> None:
    """OpenBLAS reserves its buffers at the first product and retries without end if that fails."""
    ended = subprocess.run(
        [sys.executable, "-c", FIRST_PRODUCT.format(memory_mb=memory_mb)],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert ended.stdout == "done\n", ended.stderr


def test_a_task_that_cannot_be_sent_occupies_no_worker(load_stub: LoadKinds) -> None:
    workers = LocalWorkers(load_stub, 1)
    with pytest.raises((pickle.PicklingError, AttributeError)):
        workers.submit((1, 1), "estimation", lambda: None, None)
    assert workers.free_slots == 1
    workers.close()
