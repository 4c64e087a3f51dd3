"""Selection of the modal table and of the damping, by mode names and shapes, not numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.records.modal_data import ModalKind
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.modal_tables import (
    ASSUMED_DAMPING,
    find_modal_tables,
    interpolate_damping,
    load_modes,
    open_modes,
)
from flexsid.workflow.views.model_order import OrderQuery, study_model_order

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def stored(store, kind, **arrays):
    """Return the newest table of this kind of FLEX-28 with other arrays."""
    table = [t for t in store.modal_tables.find(aircraft_id=1) if t.kind is kind][-1]
    stored = {name: store.arrays.put(np.asarray(values)) for name, values in arrays.items()}
    return replace(table, id=None, arrays=stored)


def with_warnings(store):
    modes = load_modes(store, *find_modal_tables(store, 1, None, None))
    found = dict(zip(modes.table.numbers, modes.table.zeta[0], strict=True))
    return found, modes.warnings


def damping_of(store):
    return with_warnings(store)[0]


def rotated(values):
    return (*values[1:], values[0])


def test_damping_is_not_assigned_by_mode_number(flown):
    """Modes without name or shape have no damping, in runs and in lists of modes."""
    table = stored(flown, ModalKind.GVT, zeta=np.full((2, 25), 0.11))
    names = ("",) * len(table.names)
    flown.modal_tables.add(replace(table, name="another", names=names))
    found, warnings = with_warnings(flown)
    assert set(found.values()) == {ASSUMED_DAMPING}
    assert "No damping is known for modes" in warnings[0]
    modes = open_modes(flown, flown.modal_tables.get(1))
    assert np.isnan(interpolate_damping(flown, modes, 0.5)).all()


def test_damping_is_found_by_name(flown):
    before = damping_of(flown)
    gvt = flown.modal_tables.get(2)
    zeta, omega = (flown.arrays.get(gvt.arrays[name]) for name in ("zeta", "omega"))
    turned = {"zeta": np.roll(zeta, -1, axis=1), "omega": np.roll(omega, -1, axis=1)}
    table = stored(flown, ModalKind.GVT, **turned)
    flown.modal_tables.add(
        replace(table, names=rotated(table.names), symmetric=rotated(table.symmetric))
    )  # the numbers stay: each now belongs to the mode after it
    after = damping_of(flown)
    named = [number for number, name in zip(gvt.numbers, gvt.names, strict=True) if name]
    assert len(named) > 8
    assert [after[n] for n in named] == pytest.approx([before[n] for n in named])


def test_damping_is_found_by_shape_and_never_where_the_shape_is_another(flown):
    fem, gvt = flown.modal_tables.get(1), flown.modal_tables.get(2)
    before = damping_of(flown)
    shape = flown.arrays.get(fem.arrays["shape"])[[0, -1]]
    zeta, omega = (flown.arrays.get(gvt.arrays[name]) for name in ("zeta", "omega"))
    arrays = {"zeta": np.roll(zeta, -1, 1), "omega": np.roll(omega, -1, 1)}
    arrays["shape"] = np.roll(shape, -1, 1)
    table = replace(stored(flown, ModalKind.GVT, **arrays), points=fem.points)
    flown.modal_tables.add(replace(table, names=("",) * 25))
    after, warnings = with_warnings(flown)
    assert [after[n] for n in (7, 9, 11)] == pytest.approx([before[n] for n in (7, 9, 11)])
    assert any("whose shape is similar (MAC 1.00)" in text for text in warnings)
    # The names of the model on shapes of other modes: the names are wrong.
    flown.modal_tables.add(table)
    after, warnings = with_warnings(flown)
    assert after[9] != pytest.approx(before[7], rel=1e-3)
    assert any("its shape differs" in text for text in warnings)


QUERY = OrderQuery(aircraft_id=1, airspeed_m_s=39.8, fuel=0.5, altitude_m=1524.0)


def test_model_order_uses_the_modal_table_of_the_prediction(flown):
    """A table of another name, imported later, has none of the predicted modes."""
    before = study_model_order(flown, QUERY)
    fem = flown.modal_tables.get(1)
    other = flown.modal_tables.add(
        replace(fem, id=None, name="wing alone", numbers=tuple(range(101, 126)))
    )
    assert study_model_order(flown, QUERY) == before
    assert find_modal_tables(flown, 1, None, None)[0].id == fem.id
    with pytest.raises(BadInput, match="has no generalised force of the modes of modal table"):
        study_model_order(flown, replace(QUERY, modal_table_id=other.id))
    partly = flown.modal_tables.add(
        replace(fem, id=None, numbers=(*range(1, 10), *range(110, 126)))
    )
    evidence = study_model_order(flown, replace(QUERY, modal_table_id=partly.id)).evidence
    assert any("are predicted and not in modal table 'FEM'" in text for text in evidence)
    assert any("are not in prediction" in text for text in evidence)
