"""A report as one HTML file: figures live, styles and scripts inside, nothing fetched."""

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
from flexsid.reports.content import (
    Drawing,
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    moment,
)

_NEEDED = frozenset({"title", "style", "body", "script"})
_NUMBER = ' class="number"'
_NAME = ' class="name"'
_OFFERED = _NEEDED | {"subtitle", "contents", "provenance", "made_at", "version"}


def built_in_template() -> str:
    """The page that reports are put into, to start a template of one's own from."""
    return _own("template.html")


def read_template(file: str | Path) -> str:
    """Read a template of an organisation.

    Raises
    ------
    BadInput
        If it is not there, or lacks what a report needs.
    """
    try:
        text = Path(file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"the report template {file} cannot be read: {error}") from error
    template = Template(text)
    named = set(template.get_identifiers()) if template.is_valid() else set[str]()
    if named - _OFFERED or not named >= _NEEDED:
        raise BadInput(
            f"the report template {file} must hold ${', $'.join(sorted(_NEEDED))}, may hold"
            f" ${', $'.join(sorted(_OFFERED - _NEEDED))}, and writes a dollar as $$",
            code="bad-template",
        )
    return text


def to_html(report: Report, made_at: datetime, template: str | None = None) -> str:
    """Lay a report out.

    Parameters
    ----------
    report
        What it says.
    made_at
        When it was made.
    template
        Of :func:`read_template`; the built-in one by default.
    """
    sections = [*report.sections, Section("Provenance", (Facts(report.provenance),))]
    script = f"<script>{_plotly()}</script>\n<script>{_own('report.js')}</script>"
    return Template(built_in_template() if template is None else template).substitute(
        title=escape(report.title),
        subtitle=escape(report.subtitle),
        style=f"<style>{_own('report.css')}</style>",
        contents="".join(
            f'<li><a href="#{_anchor(section)}">{escape(section.title)}</a></li>'
            for section in sections
        ),
        body="\n".join(map(_section, sections[:-1])),
        provenance=_section(sections[-1]),
        script=script,
        made_at=moment(made_at),
        version=escape(flexsid.__version__),
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
        case Facts():
            pairs = "".join(
                f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in part.pairs
            )
            return f"<dl>{pairs}</dl>"
        case ReportTable():
            return _table(part)
        case Drawing():
            spec = json.dumps(part.spec, separators=(",", ":")).replace("<", "\\u003c")
            return (
                f'<figure><div class="drawing" role="img" aria-label="{escape(part.caption)}">'
                f'</div><script type="application/json">{spec}</script>'
                f"<figcaption>{escape(part.caption)}</figcaption></figure>"
            )


def _table(table: ReportTable) -> str:
    def row(cells: tuple[str, ...], tag: str) -> str:
        kinds = [_NAME if place == 0 else "" for place in range(table.numbers_from)]
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


@lru_cache(maxsize=1)
def _plotly() -> str:
    """The drawing library in one script, which the Python package carries."""
    text = files("plotly").joinpath("package_data", "plotly.min.js").read_text(encoding="utf-8")
    # A tag that closes the script would end it early.
    return text.replace("</script", "<\\/script")


@lru_cache
def _own(name: str) -> str:
    return files("flexsid.reports").joinpath("page", name).read_text(encoding="utf-8")
