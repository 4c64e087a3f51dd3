"""Data before flight: exact modal data, predictions with typical errors."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import INPUTS, load_truth
from flexsid.demo.sources import build_modal_tables, build_model_structures, build_predictions
from flexsid.records.modal_data import ModalKind
from flexsid.sysid.model.derivatives import list_derivative_names


class ArrayStore(dict[str, np.ndarray]):
    """Arrays by generated names."""

    def save(self, array: np.ndarray) -> str:
        name = f"array {len(self)}"
        self[name] = array
        return name


def test_modal_tables_fit_the_sensors():
    truth, arrays = load_truth(), ArrayStore()
    aircraft = describe_aircraft(truth)
    model, test = build_modal_tables(truth, 1, arrays.save)
    assert (model.kind, test.kind) == (ModalKind.FEM, ModalKind.GVT)
    assert (len(model.fuel), len(model.numbers), len(model.gauges)) == (17, 25, 24)
    assert model.numbers[0] == 7
    assert model.names[0] == "SW1B"
    assert model.symmetric[:4] == (True, False, True, False)
    assert arrays[model.arrays["shape"]].shape == (17, 25, len(model.points), 6)
    assert arrays[model.arrays["node_shape"]].shape == (17, 25, 133, 6)
    assert arrays[model.arrays["nodes"]].shape == (133, 3)
    assert arrays[test.arrays["zeta"]].shape == arrays[test.arrays["omega"]].shape == (2, 25)
    for sensor in aircraft.sensors:
        assert sensor.point in (*model.points, *model.gauges)
        assert sensor.instrument in aircraft.instruments
    # In-vacuo frequencies of the design study, half fuel.
    half = arrays[model.arrays["omega"]][8] / (2.0 * np.pi)
    np.testing.assert_allclose(half[[0, 2, 4, 5]], [3.873, 10.804, 13.475, 15.008], atol=2e-3)


def test_combinations_name_recorded_channels():
    aircraft = describe_aircraft(load_truth())
    recorded = {sensor.name for sensor in aircraft.sensors}
    names = [combination.name for combination in aircraft.combinations]
    assert names[:6] == ["az_mfs", "az_mas", "az_ofs", "az_oas", "ax_oas", "ay_wls"]
    assert "s_ros1s_m45" in names
    assert len(names) == 18
    assert {name for entry in aircraft.combinations for name, _ in entry.terms} <= recorded


def test_structures_name_modes_of_the_table():
    truth = load_truth()
    modes = [structure.structure.modes for structure in build_model_structures(1)]
    assert modes == [(7,), (7, 9), (7, 9, 11, 12)]
    assert set(modes[-1]) <= set(truth.modes.numbers)


@pytest.mark.parametrize("which", [0, 1])
def test_predictions_differ_from_truth_and_are_reproducible(which: int):
    truth, arrays = load_truth(), ArrayStore()
    prediction = build_predictions(truth, 1, arrays.save)[which]
    again = ArrayStore()
    values = arrays[prediction.values]
    np.testing.assert_array_equal(
        values, again[build_predictions(truth, 1, again.save)[which].values]
    )
    names = list_derivative_names(truth.symmetric, INPUTS)
    true = truth.derivatives.reshape(17, -1)[:, [names.index(name) for name in prediction.names]]
    difference = np.abs(values / true - 1.0)
    assert 0.05 < np.median(difference) < 0.25
    assert difference.max() < 0.5
    if which == 1:
        assert prediction.std_errors is not None
        assert arrays[prediction.std_errors].min() > 0.0
        assert len(prediction.names) == 12
    else:
        assert len(prediction.names) == 10 * 23


def test_modes_are_identified_from_the_vibration_test():
    from flexsid.demo.sources import build_measured_responses
    from flexsid.sysid.modes.measured_modes import (
        compute_stabilisation,
        find_columns,
        identify_modes,
    )

    truth, arrays = load_truth(), ArrayStore()
    record = build_measured_responses(truth, 1, arrays.save)
    hertz, values = (arrays[record.arrays[name]] for name in ("frequency", "values"))
    band = hertz < 16.0
    omega = 2.0 * np.pi * hertz[band]
    columns = find_columns(compute_stabilisation(omega, values[band], 30))
    found = identify_modes(omega, values[band], columns, record.quantity)
    assert found.omega == pytest.approx(truth.modes.at(0.0).omega[:6], rel=2e-3)
