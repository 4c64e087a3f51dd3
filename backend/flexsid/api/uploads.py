"""Uploaded files, stored under generated names; names sent by a client are not used as paths."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from fastapi import UploadFile


def save_files(folder: Path, files: Sequence[UploadFile]) -> tuple[list[Path], list[str]]:
    """Write uploaded files into a folder and return their paths and original names."""
    names = [Path(file.filename or "file").name for file in files]
    paths = [folder / f"{number}{Path(name).suffix[:16]}" for number, name in enumerate(names)]
    for file, path in zip(files, paths, strict=True):
        with path.open("wb") as target:
            shutil.copyfileobj(file.file, target)
    return paths, names
