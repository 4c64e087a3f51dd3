"""Notebooks (nbformat 4) that read a run, or the sheet of a condition, by the client."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence

_Cell = tuple[str, str]
"""Kind of a cell, markdown or code, and its text."""


def write_run_notebook(
    url: str, run_id: int, maneuver_id: int, channels: Sequence[str], title: str
) -> str:
    """Write the notebook of a run: parameters, fit, poles of its model, and samples.

    Parameters
    ----------
    url
        Address of the server.
    run_id, maneuver_id
        The run, and the maneuver that it was estimated from.
    channels
        Channels whose samples are read.
    title
        Heading.
    """
    return _write(
        [
            ("markdown", f"# {title}"),
            ("code", f"{_connect(url)}\nrun_id, maneuver_id = {run_id}, {maneuver_id}"),
            ("markdown", "## Parameters with standard errors"),
            ("code", "parameters = workbench.parameters(run_id)\nparameters"),
            ("markdown", "## Fit"),
            ("code", 'workbench.figure("fit", run_id=run_id)'),
            ("markdown", "## Poles of the identified model"),
            ("code", "workbench.model(run_id).poles()"),
            ("markdown", "## Samples as the run used them"),
            (
                "code",
                f"samples = workbench.samples(maneuver_id, {list(channels)})\nsamples.describe()",
            ),
        ]
    )


def write_sheet_notebook(url: str, condition_id: int, run_ids: Sequence[int], title: str) -> str:
    """Write the notebook of the sheet of a condition: derivatives, and figures of its runs."""
    return _write(
        [
            ("markdown", f"# {title}"),
            (
                "code",
                f"import pandas\n{_connect(url)}\n"
                f"condition_id, run_ids = {condition_id}, {list(run_ids)}\n"
                'sheet = workbench.get(f"conditions/{condition_id}/sheet")\nsheet["sentence"]',
            ),
            ("markdown", "## Derivatives by source"),
            (
                "code",
                'labels = [one["label"] for one in sheet["sources"]]\n'
                "rows = {\n"
                '    row["name"]: [one and one["value"] for one in row["values"]]\n'
                '    for row in sheet["rows"]\n'
                "}\n"
                'pandas.DataFrame.from_dict(rows, orient="index", columns=labels)',
            ),
            ("code", 'workbench.figure("condition-derivatives", condition_id=condition_id)'),
            ("markdown", "## Reference run"),
            ("code", "workbench.parameters(run_ids[0]) if run_ids else None"),
            ("code", 'workbench.figure("fit", run_id=run_ids[0]) if run_ids else None'),
        ]
    )


def _connect(url: str) -> str:
    return f"from flexsid.client import Workbench\n\nworkbench = Workbench({url!r})"


def _write(cells: Iterable[_Cell]) -> str:
    written = []
    for number, (kind, text) in enumerate(cells):
        cell: dict[str, object] = {
            "cell_type": kind,
            "id": f"cell-{number}",
            "metadata": {},
            "source": text.splitlines(keepends=True),
        }
        if kind == "code":
            cell |= {"execution_count": None, "outputs": []}
        written.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = {
        "cells": written,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
