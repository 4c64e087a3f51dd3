"""Figures of a search for structure: every step and every term is on them."""

from __future__ import annotations

from dataclasses import replace

import plotly.graph_objects as go

from flexsid.figures.estimates import draw_search_path, draw_search_stability
from flexsid.records.search import SearchStep, SearchTerm, TermGroup

STEPS = (
    SearchStep(action="enter", term="Cm_alpha", f=900.0, n_terms=1, r_squared=0.8, pse=9.0, bic=50),
    SearchStep(action="enter", term="Cm_q", f=90.0, n_terms=2, r_squared=0.9, pse=2.0, bic=None),
    SearchStep(action="drop", term="Cm_q", f=3.0, n_terms=1, r_squared=0.8, pse=1.5, bic=10.0),
)
TERM = SearchTerm(
    name="Cm_alpha", selected=True, value=-0.7, std_error=0.01, f=4900.0, support=0.5,
    stability=1.0, inflation=1.2,
)  # fmt: skip
GROUP = TermGroup(
    name="Cm",
    path=STEPS,
    terms=(TERM, replace(TERM, name="Cm_q", selected=False, value=None, stability=0.1)),
    dependencies=(),
    r_squared=0.8,
    pse=1.5,
    bic=10.0,
)


def test_path_and_stability_are_figures_that_plotly_takes():
    path, bars = draw_search_path(GROUP), draw_search_stability(GROUP)
    go.Figure(path)
    go.Figure(bars)
    assert len(path["data"]) == 3
    assert path["data"][2]["y"] == [50.0, None, 10.0]
    assert path["data"][0]["marker"]["symbol"] == ["circle", "circle", "x"]
    assert [trace["y"] for trace in bars["data"]] == [[100.0], [10.0], [50.0, 50.0]]


def test_empty_search_figures_have_a_message():
    assert not draw_search_path(replace(GROUP, path=()))["data"]
    undrawn = tuple(replace(term, stability=None) for term in GROUP.terms)
    assert not draw_search_stability(replace(GROUP, terms=undrawn))["data"]
