"""A user relies on: refusals with numbers, checks of what will move, files that reproduce."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import io as matlab

from flexsid.errors import BadInput
from flexsid.sysid.excitation.catalogue import CATALOGUE, FlightTestAid
from flexsid.sysid.excitation.checks import ActuatorLimits, check_design, recognise_multisine
from flexsid.sysid.excitation.designer import (
    DesignSpecification,
    InputSpecification,
    build_multisine,
    compute_peak_factors,
    design,
    estimate_search_time_s,
    to_c_header,
    to_csv,
    to_matlab,
    write_recipe,
)
from flexsid.sysid.excitation.peak_factor import (
    THOROUGH,
    HarmonicSpectrum,
    evaluate_peak_factor,
    search_phases,
)

FLOWN = Path(__file__).parents[2].parent / "shared/data/maewing1/flight/flown_multisines"


def specification(number: int = 521) -> DesignSpecification:
    dealt = CATALOGUE[number].harmonics(6)
    inputs = tuple(
        InputSpecification(
            name=name, harmonics=tuple(own.tolist()), relative_peak=1.0 - 0.05 * index
        )
        for index, (name, own) in enumerate(dealt.items())
    )
    return DesignSpecification(
        duration_s=40.0, rate_hz=50.0, inputs=inputs, peaks=(0.5, 1.0, 2.0), effort="quick", seed=4
    )


def test_a_design_has_the_size_asked_and_is_orthogonal_at_its_rate():
    made = design(specification())
    actuator = ActuatorLimits(natural_frequency=200.0, damping=0.7)
    checks = check_design(made, 200.0, actuator, compute_peak_factors(made))
    assert checks.correlation < 1e-12
    for index, row in enumerate(checks.inputs):
        assert row.command_peak == pytest.approx(0.5 * (1.0 - 0.05 * index), rel=0.02)
        assert abs(row.start) < 1e-12
        assert row.within_limits
    assert set(compute_peak_factors(made)) == set(made.inputs)


def test_progress_reaches_the_whole():
    fractions: list[float] = []
    design(specification(503), lambda _name, _factor, fraction: fractions.append(fraction))
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)


def test_harmonics_have_the_power_that_was_asked():
    own = InputSpecification(name="u", harmonics=(2, 5, 9), power=(1.0, 4.0, 9.0))
    made = design(replace(specification(), inputs=(own,)))
    np.testing.assert_allclose(
        made.tones["u"].amplitudes / made.tones["u"].amplitudes[0], [1, 2, 3]
    )


def test_recipe_holds_the_specification_and_the_phases():
    requested = specification(503)
    made = design(requested)
    recipe = json.loads(write_recipe(requested, made))
    assert recipe["specification"]["peaks"] == list(requested.peaks)
    phases = {name: np.array(own) for name, own in recipe["phases"].items()}
    high = build_multisine(requested, phases, level=2)
    np.testing.assert_allclose(high.sample_period(50.0), 4.0 * made.sample_period(50.0), atol=1e-9)


def test_files_hold_one_period_at_the_rate(tmp_path: Path):
    made = design(specification(503))
    samples = made.sample_period(50.0)
    at = np.arange(samples.shape[0]) / 50.0
    assert np.allclose(samples, made.sample(at), atol=1e-9 * np.abs(samples).max())
    lines = to_csv(made, 50.0).splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    assert len(lines) == len(rows) + len(made.inputs) + 1
    assert rows[0] == "t_s," + ",".join(made.inputs)
    np.testing.assert_allclose(np.array(rows[8].split(","), float)[1:], samples[7], rtol=1e-8)
    (tmp_path / "design.mat").write_bytes(to_matlab(made, 50.0))
    np.testing.assert_array_equal(matlab.loadmat(tmp_path / "design.mat")["u"], samples)
    header = to_c_header(made, 50.0)
    assert f"#define EXCITATION_SAMPLES {len(samples)}" in header
    assert header.count("static const float") == 2 * len(made.inputs)


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler here")
def test_a_flight_computer_verifies_its_table(tmp_path: Path):
    """Compile the header, compute the checksums in C, and compare the samples of the self-test."""
    made = design(specification(503))
    (tmp_path / "excitation.h").write_text(to_c_header(made, 50.0))
    checks = "\n".join(
        f"wrong |= crc(excitation_{n}) != EXCITATION_CRC32_{n};"
        f" for (i = 0; i < EXCITATION_TEST_SAMPLES; i++)"
        f" wrong |= excitation_{n}[excitation_test_index[i]] != excitation_test_{n}[i];"
        for n in made.inputs
    )
    (tmp_path / "check.c").write_text(
        """#include "excitation.h"
static unsigned long crc(const float *table) {
  const unsigned char *byte = (const unsigned char *)table;
  unsigned long sum = 0xfffffffful; unsigned long i; int k;
  for (i = 0; i < 4ul * EXCITATION_SAMPLES; i++)
    for (sum ^= byte[i], k = 0; k < 8; k++)
      sum = (sum >> 1) ^ (sum & 1 ? 0xedb88320ul : 0);
  return sum ^ 0xfffffffful;
}
int main(void) { unsigned long i; int wrong = 0;
"""
        + checks
        + "\nreturn wrong; }\n"
    )
    program = tmp_path / "check"
    subprocess.run(["cc", "-Wall", "-o", program, tmp_path / "check.c"], check=True)
    assert subprocess.run([program], check=False).returncode == 0


def test_every_format_has_units_and_the_same_self_test(tmp_path: Path):
    requested = specification(521)
    made = design(requested)
    recipe = json.loads(write_recipe(requested, made))
    assert recipe["units"]["throttle"] == "1"
    assert recipe["units"]["bfs"] == "rad"
    (tmp_path / "design.mat").write_bytes(to_matlab(made, 50.0))
    stored = matlab.loadmat(tmp_path / "design.mat")
    samples = made.sample_period(50.0)
    index = stored["test_index"].ravel() - 1
    np.testing.assert_array_equal(index, recipe["self_test"]["indices"])
    np.testing.assert_array_equal(stored["test_values"], samples[index].astype(np.float32))
    checksums = recipe["self_test"]["crc32"]
    assert stored["crc32"].ravel().tolist() == list(checksums.values())
    text, header = to_csv(made, 50.0), to_c_header(made, 50.0)
    for name, checksum in checksums.items():
        assert f"{name} [{recipe['units'][name]}], CRC-32 of float32 {checksum:08x}" in text
        assert f"EXCITATION_CRC32_{name} 0x{checksum:08x}ul" in header


def test_own_samples_are_recognised():
    made = design(specification(503))
    for column, (name, tones) in zip(made.sample_period(50.0).T, made.tones.items(), strict=True):
        for samples in (column, np.append(column, column[0])):
            found, period = recognise_multisine(samples)
            assert period == column.size
            np.testing.assert_array_equal(found.harmonics, tones.harmonics, name)
            np.testing.assert_allclose(found.amplitudes, tones.amplitudes, rtol=1e-9)
            np.testing.assert_allclose(np.exp(1j * (found.phases - tones.phases)), 1.0, atol=1e-6)


def test_noise_is_no_multisine():
    with pytest.raises(BadInput, match="exactly one period"):
        recognise_multisine(np.random.default_rng(1).standard_normal(500))


@pytest.mark.skipif(not FLOWN.exists(), reason="flown multisines of mAEWing1 are not here")
def test_flown_multisines_are_recognised_and_can_be_flown_with_lower_peaks():
    files = sorted(FLOWN.glob("*.csv"))
    assert files
    for file in files:
        samples = np.loadtxt(file)
        found, period = recognise_multisine(samples)
        assert period == samples.size - 1, file.name
        again = found.sample(np.arange(period) / period)
        np.testing.assert_allclose(again + samples[:-1].mean(), samples[:-1], atol=5e-4)
        spectrum = HarmonicSpectrum(found.harmonics, found.amplitudes)
        flown = evaluate_peak_factor(spectrum, found.phases)
        assert search_phases(spectrum, THOROUGH).peak_factor < flown - 0.03, file.name


@pytest.mark.parametrize("first", [1, 6])
@pytest.mark.parametrize("aid", [aid for aid in CATALOGUE.values() if aid.periods == 4])
def test_a_row_of_4t_spans_the_band_of_its_targets(aid: FlightTestAid, first: int):
    """Its harmonics are those of Table 1 in number, spread to where the row of one T ends."""
    brief = next(
        one
        for one in CATALOGUE.values()
        if (one.periods, one.axis, one.elastic_targets) == (1, aid.axis, aid.elastic_targets)
    )
    dealt = aid.harmonics(first)
    surfaces, _ = aid.input_names()
    assert {dealt[name].size for name in surfaces} == {aid.harmonics_per_input}
    every = np.concatenate(list(dealt.values()))
    assert np.unique(every).size == every.size
    reached = np.concatenate(list(brief.harmonics().values())).max()
    assert 1.0 <= every.max() / 4 / reached < 1.1
    for name in surfaces:
        assert np.unique(np.diff(dealt[name])).size == 1


def test_the_time_of_a_search_grows_with_harmonics_band_and_effort():
    known = specification(503)
    assert estimate_search_time_s(known) < 1.0
    patient = estimate_search_time_s(replace(known, effort="patient"))
    assert patient > 10.0 * estimate_search_time_s(known)
    own = InputSpecification(name="u", harmonics=tuple(range(1, 500)))
    assert estimate_search_time_s(replace(known, inputs=(own,))) > 3.0 * estimate_search_time_s(
        known
    )
    high = InputSpecification(name="u", harmonics=(20_000,))
    assert estimate_search_time_s(replace(known, inputs=(high,))) > estimate_search_time_s(known)


def bad(**changes: Any) -> DesignSpecification:
    return replace(specification(503), **changes)


@pytest.mark.parametrize(
    ("requested", "words"),
    [
        (bad(duration_s=40.011), "samples; take 40.02 s"),
        (bad(rate_hz=5.0), r"is 3\.\d+ Hz, not below the Nyquist frequency 2\.5 Hz"),
        (bad(rate_hz=99_000.0), r"samples; a design has at most 100000"),
        (bad(inputs=(InputSpecification(name="bfs", harmonics=()),)), "bfs has no harmonics"),
        (bad(inputs=()), "has no input"),
        (
            bad(
                inputs=(
                    InputSpecification(name="a", harmonics=(3,)),
                    InputSpecification(name="b", harmonics=(3,)),
                )
            ),
            "harmonic 3 belongs to a and b",
        ),
        (bad(peaks=(2.0, 1.0, 3.0)), "rise from low to high"),
        (
            bad(inputs=(InputSpecification(name="a", harmonics=(3,), power=(1.0, 2.0)),)),
            "1 harmonics but 2",
        ),
    ],
)
def test_impossible_specifications_are_refused_with_the_numbers(
    requested: DesignSpecification, words: str
):
    with pytest.raises(BadInput, match=words):
        design(requested)


def test_deflection_follows_the_actuator():
    """A single sine at the actuator's natural frequency: gain 1/(2 zeta), exactly."""
    own = InputSpecification(name="u", harmonics=(10,))
    made = build_multisine(replace(specification(), inputs=(own,)), {"u": np.zeros(1)}, level=1)
    omega = 2.0 * np.pi * 10.0 / 40.0
    actuator = ActuatorLimits(natural_frequency=omega, damping=0.4)
    (row,) = check_design(made, 50.0, actuator, {"u": 1.0}).inputs
    assert row.deflection_peak == pytest.approx(1.25, rel=1e-4)
    assert row.rate_peak == pytest.approx(1.25 * omega, rel=1e-4)
    assert row.acceleration_peak == pytest.approx(1.25 * omega**2, rel=1e-4)
