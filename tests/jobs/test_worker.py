"""A worker that is held to its memory."""

from __future__ import annotations

import subprocess
import sys

import pytest
from waiting import PATIENCE_S

FIRST_PRODUCT = """
from flexsid.jobs.worker import _at_most
with _at_most({memory_mb}):
    import numpy as np
    import scipy.linalg
    matrix = np.eye(200)
    scipy.linalg.cho_factor(np.linalg.solve(matrix, matrix))
print("done")
"""


@pytest.mark.parametrize("memory_mb", [24, 64])
def test_the_first_product_of_matrices_does_not_hang_for_want_of_memory(memory_mb: int) -> None:
    """OpenBLAS asks for its buffers then, and where it gets none it asks for ever."""
    ended = subprocess.run(
        [sys.executable, "-c", FIRST_PRODUCT.format(memory_mb=memory_mb)],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert ended.stdout == "done\n", ended.stderr
