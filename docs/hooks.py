"""Hooks of the documentation site: reference pages, and equations as MathML."""

from __future__ import annotations

import argparse
import ast
import html
import json
import re
import sys
import tomllib
from functools import cache
from pathlib import Path
from textwrap import indent
from typing import Any

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

BACKEND = Path(__file__).parents[1] / "backend"
sys.path.insert(0, str(BACKEND))

_EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[([](.*?)\\[)\]]</\1>', re.DOTALL)
_PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]*pictures/\w+)\.png\)")
_LIBRARY = {
    "Signals": ["signals"],
    "Spectra": ["spectra"],
    "Structural modes": ["modes"],
    "Excitation": ["excitation"],
    "The model": ["model"],
    "Preparation": ["preparation"],
    "Compatibility": ["compatibility"],
    "Estimation": ["estimation"],
    "Model structure determination": ["structure_determination"],
    "Stability": ["stability"],
    "Simulation": ["simulation"],
}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the reference."""
    pages = {
        "library": _library,
        "client": _client,
        "commands": _commands,
        "rest": _rest,
        "permissions": _permissions,
        "glossary": _glossary,
    }
    for name, make in pages.items():
        files.append(File.generated(config, f"reference/{name}.md", content=make()))
    return files


def on_page_markdown(markdown: str, **_kwargs: Any) -> str:
    """Print layers and variables, and show every picture in the theme of the page."""
    for mark, make in (("<!-- layers -->", _layers), ("<!-- variables -->", _variables)):
        if mark in markdown:
            markdown = markdown.replace(mark, make())
    return _PICTURE.sub(r"![\1](\2.png#only-light)\n![\1](\2-dark.png#only-dark)", markdown)


def on_page_content(content: str, **_kwargs: Any) -> str:
    """Turn equations into MathML."""

    def mathml(found: re.Match[str]) -> str:
        display = "block" if found[1] == "div" else "inline"
        return convert(html.unescape(found[2]).strip(), display=display)

    return _EQUATION.sub(mathml, content)


def _variables() -> str:
    """Return the variables of the environment as their fields declare them."""
    from flexsid.settings import list_variables

    lines = ["| variable | meaning | value | default |", "| --- | --- | --- | --- |"]
    for name, meaning, values, default in list_variables():
        shown = f"`{default}`" if default else ""
        lines.append(f"| `{name}` | {_cell(meaning)} | {_cell(values)} | {shown} |")
    return "\n".join(lines)


def _layers() -> str:
    """Return the layers of the import contract with the docstrings of their packages."""
    project = tomllib.loads((BACKEND.parent / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    layers = next(each["layers"] for each in contracts if each["id"] == "layers")
    lines = ["| layer | package | contents |", "| --- | --- | --- |"]
    for number, layer in enumerate(layers, start=1):
        for package in re.findall(r"\w+", layer):
            lines.append(f"| {number} | `{package}` | {_cell(_summary(package))} |")
    return "\n".join(lines)


def _summary(package: str) -> str:
    """Return the first line of the docstring of a package or module of ``flexsid``."""
    folder = BACKEND / "flexsid" / package
    file = folder / "__init__.py" if folder.is_dir() else folder.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return text.partition("\n")[0].replace("``", "`")


def _library() -> str:
    lines = [
        "# Library",
        "",
        "`flexsid.sysid` holds the methods of system identification: arrays and frozen values,",
        "in SI units and radians.",
        "",
    ]
    for title, folders in _LIBRARY.items():
        found = [name for folder in folders for name in _modules(f"sysid/{folder}")]
        if found:
            lines += [f"## {title}", "", *(f"::: {name}\n" for name in found)]
    return "\n".join(lines)


def _client() -> str:
    return "\n".join(
        [
            "# Python client",
            "",
            "The workbench over HTTP; see [Work from a notebook](../how-to/notebook.md).",
            "",
            "::: flexsid.client.workbench.Workbench",
            "",
            "::: flexsid.client.connection.RunFailed",
            "",
            "::: flexsid.client.connection.RequestRefused",
            "",
            "::: flexsid.client.connection.Unreachable",
            "",
        ]
    )


def _modules(folder: str) -> list[str]:
    """Return the dotted names of the public modules in a folder of the package."""
    package = BACKEND / "flexsid"
    single = package / f"{folder}.py"
    found = [single] if single.is_file() else sorted((package / folder).glob("*.py"))
    return [
        ".".join(path.relative_to(BACKEND).with_suffix("").parts)
        for path in found
        if not path.name.startswith("_")
    ]


def _commands() -> str:
    from flexsid.cli.main import build_parser

    parser = build_parser()
    lines = [
        "# Command line",
        "",
        "Every command has `--database URL`, and `--json` for JSON output; progress is shown on",
        "standard error.",
        "",
        "| command | does |",
        "| --- | --- |",
    ]
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            lines += [
                f"| [`flexsid {name}`](#flexsid-{name}) | {_cell(does)} |"
                for name, does in ((each.dest, each.help or "") for each in action._choices_actions)
            ]
            lines.append("")
            for name, command in action.choices.items():
                usage = command.format_help().replace(command.prog, f"flexsid {name}", 1)
                lines += [f"## flexsid {name}", "", "```text", usage.rstrip(), "```", ""]
    return "\n".join(lines)


@cache
def _describe_interface() -> dict[str, Any]:
    from flexsid.api.app import create_app
    from flexsid.settings import Settings

    return create_app(Settings()).openapi()


def _rest() -> str:
    schema = _describe_interface()
    lines = [
        "# REST",
        "",
        "The page uses only this interface. Lists return",
        '`{"items": [...], "next": ...}`; errors return `application/problem+json`',
        "(RFC 9457) with a stable `code`. The OpenAPI description is at `/api/v1/openapi.json` of",
        "a running server; `/api/docs` shows it.",
        "",
        "    curl -s -X POST http://127.0.0.1:8000/api/v1/runs \\",
        "      -H 'Content-Type: application/json' \\",
        """      -d '{"maneuver_id": 1, "method": "OE", "structure": {"modes": [7, 9]}}'""",
        "",
        "responds `202 Accepted` with the run and, in `Location`, its job.",
        "",
    ]
    by_tag: dict[str, list[str]] = {}
    for path, methods in schema["paths"].items():
        for method, operation in methods.items():
            by_tag.setdefault(operation["tags"][0], []).extend(_operation(path, method, operation))
    for tag, parts in by_tag.items():
        lines += [f"## {tag.replace('-', ' ').capitalize()}", "", *parts]
    return "\n".join(lines)


def _permissions() -> str:
    from flexsid.api.permissions import write_permissions

    return write_permissions(_describe_interface()["paths"])


def _operation(path: str, method: str, operation: dict[str, Any]) -> list[str]:
    lines = [f"### {method.upper()} {path}", "", operation.get("description", ""), ""]
    parameters = operation.get("parameters", ())
    if parameters:
        lines += ["| parameter | in | meaning | example |", "| --- | --- | --- | --- |"]
        lines += [
            f"| `{p['name']}`{'' if p['required'] else ' (optional)'} | {p['in']} |"
            f" {_cell(p.get('description', ''))} | {_cell(_shown(p.get('example')))} |"
            for p in parameters
        ]
        lines.append("")
    body = operation.get("requestBody", {}).get("content", {}).get("application/json", {})
    if "example" in body:
        lines += ["```json", _write(body["example"]), "```", ""]
    for status, response in operation["responses"].items():
        example = response.get("content", {}).get("application/json", {}).get("example")
        if status.startswith("2") and example is not None:
            block = indent("\n".join(["```text", _write(example), "```"]), "    ")
            lines += [f'??? example "Response {status}"', "", block, ""]
    return lines


def _write(example: Any) -> str:
    return json.dumps(example, indent=2, ensure_ascii=False)


def _shown(example: Any) -> str:
    return "" if example is None else f"`{example}`"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def _glossary() -> str:
    from flexsid.nomenclature import GLOSSARY

    lines = [
        "# Glossary",
        "",
        "Names in code, files, URLs and figures. Values are in SI units and radians; figures use",
        "the display unit.",
        "",
        "| name | symbol | unit | shown in | meaning |",
        "| --- | --- | --- | --- | --- |",
    ]
    lines += [
        f"| `{symbol.symbol}` | {symbol.html} | {symbol.unit or '–'} |"
        f" {symbol.display_unit or '–'} | {_cell(symbol.meaning)} |"
        for symbol in GLOSSARY
    ]
    return "\n".join(lines) + "\n"
