"""Plotly figures as plain data, from computed values."""

from flexsid.figures.bode import View, bode
from flexsid.figures.closed_loop import closed_loop_margins, closed_loop_roots
from flexsid.figures.derivatives import derivatives
from flexsid.figures.envelope import envelope
from flexsid.figures.equivalent_modes import equivalent_modes
from flexsid.figures.excitation import (
    design_history,
    design_signal,
    design_spectrum,
    design_worth,
)
from flexsid.figures.fit import fit
from flexsid.figures.flutter import flutter_forecast, flutter_map
from flexsid.figures.forest import forest
from flexsid.figures.ground_test import ground_test
from flexsid.figures.iterations import iterations
from flexsid.figures.loops import loops
from flexsid.figures.parameter_correlation import parameter_correlation
from flexsid.figures.plot_matrix import plot_matrix
from flexsid.figures.poles import poles
from flexsid.figures.reconstruction import reconstruction, reconstruction_lines
from flexsid.figures.residual import residual
from flexsid.figures.roots import root_locus, v_omega_zeta
from flexsid.figures.search import search_path, search_stability
from flexsid.figures.signal_to_noise import signal_to_noise
from flexsid.figures.spectrum import spectrum
from flexsid.figures.structure import (
    assurance,
    model_order,
    modes_against_fuel,
    reduced_responses,
    stabilisation,
)
from flexsid.figures.time_check import time_check
from flexsid.figures.time_history import time_history
from flexsid.figures.trend import trend

__all__ = [
    "View",
    "assurance",
    "bode",
    "closed_loop_margins",
    "closed_loop_roots",
    "derivatives",
    "design_history",
    "design_signal",
    "design_spectrum",
    "design_worth",
    "envelope",
    "equivalent_modes",
    "fit",
    "flutter_forecast",
    "flutter_map",
    "forest",
    "ground_test",
    "iterations",
    "loops",
    "model_order",
    "modes_against_fuel",
    "parameter_correlation",
    "plot_matrix",
    "poles",
    "reconstruction",
    "reconstruction_lines",
    "reduced_responses",
    "residual",
    "root_locus",
    "search_path",
    "search_stability",
    "signal_to_noise",
    "spectrum",
    "stabilisation",
    "time_check",
    "time_history",
    "trend",
    "v_omega_zeta",
]
