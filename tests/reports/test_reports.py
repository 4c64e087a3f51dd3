"""Reports have all results and are self-contained."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from flexsid.demo.campaign import add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput, Conflict
from flexsid.jobs.dispatcher import execute_request, execute_run
from flexsid.jobs.kinds import FLUTTER, RUN
from flexsid.records.decision import Structure
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.run import EstimationRun, Method, OutputQuality
from flexsid.reports import (
    Report,
    built_in_template,
    campaign_report,
    comparison_report,
    read_template,
    run_card,
    run_report,
    to_html,
    to_pdf,
)
from flexsid.reports.content import Drawing, ReportTable, Section, Words, draw, estimate, number
from flexsid.reports.run import select_outputs, tabulate_fit
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.workflow.excitation.excitation_designs import specify_design
from flexsid.workflow.flutter.flutter_models import FlutterQuery

NOW = datetime(2026, 3, 1, 12, 30, tzinfo=UTC)
SMALL = Report(
    title="A <b>bold</b> title",
    subtitle="flight 1",
    name="small",
    sections=(
        Section(
            "One section",
            (
                Words("5 < 6 & $7", warns=True),
                ReportTable(("name", "value"), (("a", "1"),), "a table"),
                Drawing({"data": [{"name": "</script><b>"}], "layout": {}}, "a figure"),
            ),
        ),
    ),
    provenance=(("File", "a.mat"),),
)


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def figures(html: str) -> list[dict]:
    return [
        json.loads(text)
        for text in re.findall(r'<script type="application/json">(.*?)</script>', html)
    ]


def test_a_page_is_whole_and_safe() -> None:
    html = to_html(SMALL, NOW)
    assert "A &lt;b&gt;bold&lt;/b&gt; title" in html
    assert '<p class="warning">5 &lt; 6 &amp; $7</p>' in html
    assert '<th class="number">value</th>' in html
    assert figures(html)[0]["data"][0]["name"] == "</script><b>"
    assert "2026-03-01 12:30 UTC" in html
    assert '<a href="#one-section">' in html
    assert "<dt>File</dt><dd>a.mat</dd>" in html
    # Nothing is fetched: no address in any attribute that loads.
    outside = re.sub(r"<script>.*?</script>", "", html, flags=re.DOTALL)
    assert not re.search(r"""(src|href)=["']?(https?:)?//""", outside)


def test_a_run_is_reported_with_all_its_figures(flown: Store) -> None:
    report = run_report(flown, 1)
    parts = {section.title: section.parts for section in report.sections}
    assert list(parts) == [
        *("Summary", "Flight condition", "Derivatives", "Fit", "Model adequacy"),
        *("Uncertainty", "Poles", "Credibility"),
    ]
    assert not [part for part in parts["Fit"] if isinstance(part, Words)]
    table = next(part for part in parts["Derivatives"] if isinstance(part, ReportTable))
    parameters = flown.runs.get(1).result
    assert parameters is not None
    assert [row[1] for row in table.rows] == [each.name for each in parameters.parameters]
    provenance = dict(report.provenance)
    assert "flexsid" in provenance["Versions"]
    assert provenance["Covariance"] == parameters.covariance
    html = to_html(report, NOW)
    assert len(figures(html)) >= 8
    assert html.count("<h2>") == 9


def test_a_run_of_many_responses_is_reported_on_few_pages(flown: Store) -> None:
    """As FRE of five inputs, whose 125 figures took 28 pages: the lowest R² are drawn."""
    run = flown.runs.get(1)
    assert run.result is not None
    (block, *_) = run.result.blocks
    names = [f"y{k}" for k in range(8)]
    inputs = [f"u{k}" for k in range(10)]
    quality = tuple(
        OutputQuality(
            block=one, output=name, r_squared=0.99 - 0.1 * (k in (2, 5)), theil=0.1, whiteness=0.5
        )
        for one in inputs
        for k, name in enumerate(names)
    )
    blocks = tuple(replace(block, name=one, outputs=tuple(names)) for one in inputs)
    fit = replace(run.result.fit, quality=quality)
    result = replace(run.result, fit=fit, blocks=blocks)
    assert select_outputs(result) == [(one, ("y2", "y5")) for one in inputs]
    (table,) = tabulate_fit(result)
    assert table.head == ("output", *inputs, "Theil", "whiteness")
    assert [row[:2] for row in table.rows[1:3]] == [("y1", "0.990"), ("y2", "0.890")]


def test_a_comparison_is_reported_coefficient_by_coefficient(flown: Store) -> None:
    report = comparison_report(flown, [1], [1])
    titles = [section.title for section in report.sections]
    assert titles == ["Summary", "CZ", "Cm", "CQ7", "CQ9"]
    assert dict(report.provenance)["Run 1"].startswith("finished ")
    (figure, table) = report.sections[2].parts
    assert isinstance(figure, Drawing)
    assert isinstance(table, ReportTable)
    assert table.rows[0][0] == "Cm_alpha"
    assert " ± " in table.rows[0][1]
    with pytest.raises(BadInput, match="at least one run"):
        comparison_report(flown, [], [1])


def test_a_campaign_is_reported_as_narrowed(flown: Store) -> None:
    report = campaign_report(flown)
    assert report.subtitle == "1 flight, 1 maneuver, 1 run"
    parts = {section.title: section.parts for section in report.sections}
    assert list(parts) == ["Summary", "Flights", "Maneuvers", "Flutter", "Ground tests"]
    (table,) = parts["Maneuvers"]
    assert isinstance(table, ReportTable)
    assert (table.rows[0][0], table.rows[0][-1]) == ("flown", "EE")
    assert dict(report.provenance)["Runs"] == "1"
    with pytest.raises(Conflict, match="no maneuver"):
        campaign_report(flown, search="nothing is called so")


def test_a_campaign_report_has_trends_and_flutter(flown: Store) -> None:
    again = fly(fta=506, airspeed_ratio=0.8, label="faster")
    maneuver = add_maneuver(flown, again, flown.maneuvers.get(1).flight_id)
    request = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=flown.runs.get(1).settings,
    )
    run = execute_run(flown, request, RUN, lambda progress: None)
    missing = {section.title: section.parts for section in campaign_report(flown).sections}
    assert "not-computed" in str(missing["Flutter"])
    query = FlutterQuery(run_ids=(run.id or 0, 1))
    execute_request(flown, FLUTTER, query, lambda progress: None)
    parts = {section.title: section.parts for section in campaign_report(flown).sections}
    assert all(isinstance(part, Drawing) for part in parts["Estimates"])
    assert len(parts["Estimates"]) == 5
    assert any(
        "Flutter of SW1B" in part.text for part in parts["Flutter"] if isinstance(part, Words)
    )
    (table,) = [part for part in parts["Flutter"] if isinstance(part, ReportTable)]
    assert {row[1] for row in table.rows} == {"flown", "faster"}


def test_a_run_without_result_is_not_reported(add_run, store: Store) -> None:
    with pytest.raises(Conflict, match="queued"):
        run_report(store, add_run().id)


def test_a_figure_that_fails_leaves_the_report_alone(store: Store) -> None:
    assert draw("Fit", store, "fit", run_id=99) == Words("Fit: not available (there is no run 99).")


@pytest.mark.parametrize(
    ("value", "std_error", "written"),
    [
        (-4.99947, 0.0721, ("−4.999", "0.072")),
        (0.00071, 0.0015, ("0.0007", "0.0015")),
        (205.4, 31.0, ("205", "31")),
        (1.25, None, ("1.250", "–")),
        (1e12, 1e10, ("1.000e+12", "1.0e+10")),
    ],
)
def test_estimates_are_written_to_their_error(value, std_error, written) -> None:
    assert estimate(value, std_error) == written


def test_numbers_are_written_as_people_read_them() -> None:
    assert [number(x) for x in (None, float("nan"), 0.0, -0.012345, 123456.7)] == [
        *("–", "–", "0", "−0.01235", "123457"),
    ]


def test_an_organisation_brings_its_own_template(tmp_path: Path) -> None:
    own = tmp_path / "own.html"
    own.write_text("<title>$title</title>$style<p>ACME, $$5</p>$body$script")
    html = to_html(SMALL, NOW, read_template(own))
    assert "<p>ACME, $5</p>" in html
    assert "One section" in html
    own.write_text(built_in_template())
    assert to_html(SMALL, NOW, read_template(own)) == to_html(SMALL, NOW)
    for text in (
        "$title only",
        "$title $style $body $script $logo",
        "$title $style $body $script $",
    ):
        own.write_text(text)
        with pytest.raises(BadInput, match=r"must have \$body"):
            read_template(own)
    with pytest.raises(BadInput, match="cannot be read"):
        read_template(tmp_path / "none.html")


def test_a_report_is_printed_where_there_is_a_browser(monkeypatch, tmp_path: Path) -> None:
    if shutil.which("chromium") is None:
        pytest.skip("there is no Chromium here")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    left, used = (tmp_path / f"flexsid-report-{name}" for name in ("killed", "beside"))
    for folder in (left, used):
        folder.mkdir()
    os.utime(left, (0.0, 0.0))  # of a worker that was killed while it printed
    assert to_pdf(to_html(SMALL, NOW)).startswith(b"%PDF")
    assert list(tmp_path.glob("flexsid-report-*")) == [used]
    monkeypatch.setenv("PATH", "")
    with pytest.raises(Conflict, match="open the HTML report"):
        to_pdf("<p>")


def test_the_run_card_of_all_surfaces_is_one_page(tmp_path: Path) -> None:
    if shutil.which("chromium") is None:
        pytest.skip("there is no Chromium here")
    specification = specify_design(556, 24.0, 100.0, 6, (0.01, 0.02, 0.04), "quick")
    names = [each.name for each in specification.inputs]
    design = ExcitationDesign(
        name="FTA 556",
        specification=specification,
        phases={each.name: (0.0,) * len(each.harmonics) for each in specification.inputs},
        peak_factors=dict.fromkeys(names, 1.1),
        fta=556,
    )
    url = f"sqlite:///{tmp_path / 'designs.db'}"
    upgrade(url)
    store = Store.open(url)
    card = run_card(store, store.designs.add(design).id or 0, 1)
    store.close()
    assert len(names) == 10
    assert to_pdf(to_html(card, NOW)).count(b"/Type /Page\n") == 1


def test_the_credibility_sheet_has_all_factors_and_visible_blanks(flown: Store):
    (sheet,) = (one for one in run_report(flown, 1).sections if one.title == "Credibility")
    (table,) = (part for part in sheet.parts if isinstance(part, ReportTable))
    evidence = {row[0]: row[1] for row in table.rows}
    assert list(evidence) == [
        *("Data pedigree", "Verification", "Validation", "Input pedigree"),
        *("Uncertainty characterization", "Results robustness", "Use history"),
        *("M&S management", "People qualifications"),
    ]
    assert "quality of the data: 1 not checked" in evidence["Data pedigree"]
    assert "1 without a source file (simulated)" in evidence["Data pedigree"]
    assert evidence["Use history"] == "NOT STATED"
    assert all(row[2] == "" for row in table.rows), "levels are not claimed"
