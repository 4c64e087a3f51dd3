"""Files of a request, under names of our own; a client's name may point anywhere."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from fastapi import UploadFile


def receive(folder: Path, files: Sequence[UploadFile]) -> tuple[list[Path], list[str]]:
    """Write what was sent into a folder and return where it lies, and what it was called."""
    names = [Path(file.filename or "file").name for file in files]
    paths = [folder / f"{number}{Path(name).suffix[:16]}" for number, name in enumerate(names)]
    for file, path in zip(files, paths, strict=True):
        with path.open("wb") as target:
            shutil.copyfileobj(file.file, target)
    return paths, names
