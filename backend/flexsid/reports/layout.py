"""Layout of a report as a self-contained HTML file with interactive figures."""

from __future__ import annotations

import json
from datetime import datetime
from functools import lru_cache
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template

import flexsid
from flexsid.errors import BadInput
from flexsid.figures.spec import Spec
from flexsid.reports.content import (
    Drawing,
    Facts,
    Markdown,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
)
from flexsid.reports.figure import PrintedFigure
from flexsid.workflow.maintenance.printed_reports import FIGURE_SCRIPT, MADE_AT, complete_document
from flexsid.workflow.review.notes import render_markdown

_NEEDED = frozenset({"title", "style", "body", "script"})
_SINGLE_PAGE = """@media print {
  h1 { font-size: 1.4rem; }
  h2 { margin: 0.7rem 0 0.3rem; font-size: 1.05rem; }
  p, dl, table { margin: 0.1rem 0; }
  dl { grid-template-columns: repeat(2, max-content 1fr); }
  figure { margin: 0.2rem 0; }
}
"""
_NUMBER = ' class="number"'
_NAME = ' class="name"'
_OFFERED = _NEEDED | {"subtitle", "contents", "provenance", "made_at", "version"}


def built_in_template() -> str:
    """Return the built-in HTML template."""
    return _read_resource("template.html")


def read_template(file: str | Path) -> str:
    """Read a template of an organisation.

    Raises
    ------
    BadInput
        If the file cannot be read, or lacks a required field.
    """
    try:
        text = Path(file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"the report template {file} cannot be read: {error}") from error
    template = Template(text)
    named = set(template.get_identifiers()) if template.is_valid() else set[str]()
    if named - _OFFERED or not named >= _NEEDED:
        raise BadInput(
            f"the report template {file} must have ${', $'.join(sorted(_NEEDED))}, may have"
            f" ${', $'.join(sorted(_OFFERED - _NEEDED))}, and must write a dollar sign as $$",
            code="bad-template",
        )
    return text


def to_html(report: Report, made_at: datetime, template: str | None = None) -> str:
    """Render a report as HTML.

    Parameters
    ----------
    report
        Content of the report.
    made_at
        Date and time of the report.
    template
        Of :func:`read_template`; the built-in one by default.
    """
    return complete_document(to_document(report, template), made_at)


def to_document(report: Report, template: str | None = None) -> str:
    """Render a report as HTML with marks for its time and the script of the figures."""
    sections = [*report.sections, Section("Provenance", (Facts(report.provenance),))]
    style = _read_resource("report.css") + (_SINGLE_PAGE if report.single_page else "")
    script = f"{FIGURE_SCRIPT}\n<script>{_read_resource('report.js')}</script>"
    return Template(built_in_template() if template is None else template).substitute(
        title=escape(report.title),
        subtitle=escape(report.subtitle),
        style=f"<style>{style}</style>",
        contents="".join(
            f'<li><a href="#{_anchor(section)}">{escape(section.title)}</a></li>'
            for section in sections
        ),
        body="\n".join(map(_section, sections[:-1])),
        provenance=_section(sections[-1]),
        script=script,
        made_at=MADE_AT,
        version=escape(flexsid.__version__),
    )


def to_page(figure: PrintedFigure) -> str:
    """Render a figure as HTML of its size, with a mark for the script of the figures."""
    size = f"{figure.width_mm}mm {figure.height_mm}mm"
    style = f"@page {{ size: {size}; margin: 0; }} body, figure {{ margin: 0; overflow: hidden; }}"
    style += " @media print { .modebar { display: none; } }"
    return (
        f'<!doctype html>\n<html lang="en">\n<head><meta charset="utf-8">'
        f"<title>{escape(figure.title)}</title><style>{style}</style></head>\n<body>"
        f"{_draw(figure.spec, figure.title)}</figure>\n{FIGURE_SCRIPT}\n"
        f"<script>{_read_resource('report.js')}</script>\n</body>\n</html>\n"
    )


def _section(section: Section) -> str:
    parts = "\n".join(map(_part, section.parts))
    return (
        f'<section id="{_anchor(section)}">\n<h2>{escape(section.title)}</h2>\n{parts}\n</section>'
    )


def _anchor(section: Section) -> str:
    return "".join(c if c.isalnum() else "-" for c in section.title.lower())


def _part(part: Part) -> str:
    match part:
        case Words():
            kind = ' class="warning"' if part.warns else ""
            return f"<p{kind}>{escape(part.text)}</p>"
        case Markdown():
            origin = f'<p class="origin">{escape(part.origin)}</p>'
            return f'<div class="note">{origin}{render_markdown(part.text)}</div>'
        case Facts():
            pairs = "".join(
                f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in part.pairs
            )
            return f"<dl>{pairs}</dl>"
        case ReportTable():
            return _table(part)
        case Drawing():
            caption = f"<figcaption>{escape(part.caption)}</figcaption>"
            return f"{_draw(part.spec, part.caption)}{caption}</figure>"


def _draw(spec: Spec, name: str) -> str:
    numbers = json.dumps(spec, separators=(",", ":")).replace("<", "\\u003c")
    return (
        f'<figure><div class="drawing" role="img" aria-label="{escape(name)}"></div>'
        f'<script type="application/json">{numbers}</script>'
    )


def _table(table: ReportTable) -> str:
    def row(cells: tuple[str, ...], tag: str) -> str:
        kinds = [_NAME if index == 0 else "" for index in range(table.numbers_from)]
        kinds += [_NUMBER] * (len(cells) - table.numbers_from)
        written = (
            f"<{tag}{kind}>{escape(cell)}</{tag}>" for kind, cell in zip(kinds, cells, strict=True)
        )
        return f"<tr>{''.join(written)}</tr>"

    rows = "\n".join(row(cells, "td") for cells in table.rows)
    return (
        f'<div class="wide"><table><caption>{escape(table.caption)}</caption>'
        f"<thead>{row(table.head, 'th')}</thead>\n<tbody>{rows}</tbody></table></div>"
    )


@lru_cache
def _read_resource(name: str) -> str:
    return files("flexsid.reports").joinpath("page", name).read_text(encoding="utf-8")
