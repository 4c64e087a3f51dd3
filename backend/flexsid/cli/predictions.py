"""Command ``flexsid predict``: derivatives from a planform."""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from flexsid.api.models.prediction_requests import ComputePredictionRequest
from flexsid.cli.database import open_store
from flexsid.cli.output import print_error, print_result
from flexsid.cli.runs import report_progress
from flexsid.errors import BadInput
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kinds import PREDICTION
from flexsid.settings import Settings
from flexsid.workflow.modal_data.computed_predictions import PredictionRequest, check_prediction


def predict(settings: Settings, arguments: argparse.Namespace) -> int:
    """Compute a prediction from a planform file, store it and print its derivatives."""
    request = read_planform(Path(arguments.file))
    with open_store(settings) as store:
        check_prediction(store, request)
        job = execute_request(store, PREDICTION, request, report_progress)
        if job.error is not None:
            print_error(job.error["message"], job.error["code"], as_json=arguments.json)
            return 1
        stored = store.predictions.get((job.result or {})["prediction_id"])
        values = store.arrays.get(stored.values)[0]
        errors = store.arrays.get(stored.std_errors or "")[0]
    lines = [f"prediction {stored.id}: {stored.source}, {stored.note}"]
    lines += [
        f"  {name:<16}{value:>12.5g} ± {error:.3g}"
        if np.isfinite(value)
        else f"  {name:<16}not predicted"
        for name, value, error in zip(stored.names, values, errors, strict=True)
    ]
    print_result(lines, stored, as_json=arguments.json)
    return 0


def read_planform(file: Path) -> PredictionRequest:
    """Read the request of a prediction from a TOML file; a deck may be in a file beside it.

    Raises
    ------
    BadInput
        If a file cannot be read, or a field is not valid.
    """
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
        deck = content.pop("deck_file", None)
        if deck is not None:
            content["deck"] = (file.parent / deck).read_text(encoding="latin-1")
        body = ComputePredictionRequest.model_validate(content)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise BadInput(f"{file} cannot be read: {error}", code="unreadable-file") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise BadInput(f"{file}: {where}: {first['msg']}", code="bad-planform") from error
    return body.to_request()
