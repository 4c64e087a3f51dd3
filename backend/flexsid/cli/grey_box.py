"""Fit of grey-box models to maneuvers from the command line."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from flexsid.cli.administration import open_store
from flexsid.cli.output import parse_band, parse_list, print_next_result
from flexsid.cli.runs import compute_result
from flexsid.errors import BadInput
from flexsid.jobs.kinds import GREY_BOX
from flexsid.records.grey_box import GreyBoxFit
from flexsid.settings import Mode, Settings
from flexsid.text import LONGEST_TEXT
from flexsid.workflow.measurements.grey_box_fits import GreyBoxQuery


def fit_grey_boxes(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the parameters of a grey-box model, fitted to each maneuver."""
    low_hz, high_hz = parse_band(arguments.band) or (None, None)
    model, source = _read_model(settings, arguments.model)
    with open_store(settings) as store:
        for number in parse_list(arguments.maneuver, int, "--maneuver"):
            query = GreyBoxQuery(
                maneuver_id=number,
                model=model,
                source=source,
                method=arguments.method,
                low_hz=low_hz,
                high_hz=high_hz,
            )
            fit = compute_result(store, GREY_BOX, query)
            print_next_result("\n".join(_format_fit(fit)), fit, as_json=arguments.json)
    return 0


def _read_model(settings: Settings, model: str) -> tuple[str, str]:
    """Return the name of a model, and the text of its file; no text where it is installed."""
    file = Path(model)
    if file.suffix != ".py":
        return model, ""
    if settings.mode is not Mode.PERSONAL:
        raise BadInput(
            "the code of a file is executed in personal mode only; install a package with the "
            "entry point flexsid.models",
            code="code-refused",
        )
    if not file.is_file():
        raise BadInput(f"there is no file {model}")
    text = file.read_text(encoding="utf-8")
    if not text or len(text) > LONGEST_TEXT:
        raise BadInput(f"{model} has {len(text)} characters; expected 1 to {LONGEST_TEXT}")
    return file.name, text


def _format_fit(fit: GreyBoxFit) -> Iterator[str]:
    low, high = fit.band_hz
    yield (
        f"maneuver {fit.maneuver_id}, {fit.title}, {fit.method}, {low:.3g} to {high:.3g} Hz,"
        f" {fit.n_frequencies} frequencies"
    )
    yield f"  {'parameter':<16}{'value ± standard error':>26}  unit"
    for one in fit.parameters:
        yield f"  {one.name:<16}{_format(one.value, one.std):>26}  {one.unit or '1'}"
    if fit.poles:
        yield f"  {'pole':<16}{'frequency [rad/s]':>26}{'damping ratio':>26}"
    for number, pole in enumerate(fit.poles, start=1):
        frequency = _format(pole.frequency_rad_s, pole.frequency_std_rad_s)
        yield f"  {number:<16}{frequency:>26}{_format(pole.damping, pole.damping_std):>26}"
    yield f"  {fit.sentence}"
    yield f"  BIC {fit.bic:.1f}; derivatives by {fit.derivatives}"
    for warning in fit.warnings:
        yield f"  Warning: {warning}"


def _format(value: float, std: float | None) -> str:
    return f"{value:.4g}" if std is None else f"{value:.4g} ± {std:.2g}"
