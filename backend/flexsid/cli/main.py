"""The ``flexsid`` command: parses the arguments and dispatches to one command.

Each command imports its modules when it runs, so that ``--help`` is fast.
"""

from __future__ import annotations

import argparse
import logging
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import NoReturn

import flexsid
from flexsid.errors import BadInput, FlexsidError
from flexsid.settings import DEFAULT_DATABASE, Settings, read_settings

_METHODS = ("OE", "FRE", "EE")
_STARTS = ("best", "equation-error", "prediction", "residualized-prediction")


def main(command_line: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code: 0, 1 for a failure, 2 for bad input."""
    # Before numpy is imported: one BLAS thread, since the matrices are small and cores are shared.
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("flexsid").setLevel(logging.INFO)
    given = sys.argv[1:] if command_line is None else command_line
    as_json = "--json" in given
    try:
        arguments = _parser().parse_args(given)
        settings = read_settings()
        if arguments.database is not None:
            settings = replace(settings, database=arguments.database)
        return arguments.command(settings, arguments)
    except FlexsidError as error:
        from flexsid.cli.output import print_error

        print_error(error.message, error.code, as_json=as_json)
        return 2 if isinstance(error, BadInput) else 1
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # the reader has closed the pipe, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{message}; see {self.prog} --help", code="bad-arguments")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="flexsid", description="Identify flexible aircraft from flight test.")
    parser.add_argument("--version", action="version", version=f"flexsid {flexsid.__version__}")
    commands = parser.add_subparsers(required=True, metavar=None)

    def add(name: str, command: object, summary: str) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=summary, description=f"{summary.capitalize()}.")
        added.add_argument(
            "--database",
            metavar="URL",
            help=f"URL of the database; default: FLEXSID_DATABASE, else {DEFAULT_DATABASE}",
        )
        added.add_argument("--json", action="store_true", help="print the result as JSON")
        added.set_defaults(command=command)
        return added

    add("serve", _serve, "serve the page and the REST interface on this computer")

    demo = add("demo", _demo, "fill an empty workbench with the demonstration campaign, then serve")
    demo.add_argument("--no-serve", action="store_true", help="exit after filling")

    add("migrate", _migrate, "upgrade the database to the current schema, after a backup copy")

    add("check", _check, "check the database for damage: hashes, references, decisions")

    copy = add("backup", _backup, "back up the database into a new file, while servers use it")
    copy.add_argument("file", metavar="FILE")

    back = add(
        "restore", _restore, "replace the database by a backup, after a copy of the database"
    )
    back.add_argument("file", metavar="FILE")

    bring = add("import", _import, "import files with a mapping")
    bring.add_argument("files", nargs="+", metavar="FILE", help="recorder file or table")
    bring.add_argument(
        "--mapping",
        metavar="TOML",
        help="names channels, units and roles; not needed for recognised formats",
    )
    bring.add_argument(
        "--aircraft", type=int, metavar="ID", help="aircraft, if the mapping names none"
    )
    bring.add_argument(
        "--confirm",
        action="store_true",
        help="confirm the values that the mapping marks as guessed",
    )
    bring.add_argument("--each", action="store_true", help="import every file as its own maneuver")

    run = add("run", _run, "estimate from maneuvers")
    run.add_argument(
        "--maneuver",
        required=True,
        metavar="ID,ID",
        help="ids of maneuvers, each estimated separately",
    )
    run.add_argument("--method", choices=_METHODS, required=True)
    run.add_argument(
        "--structure",
        metavar="ID[:VERSION]",
        help="saved model structure; default: the options below, else the proposed structure",
    )
    run.add_argument(
        "--modes",
        metavar="M,N",
        help="numbers of structural modes, '' for none; default: the modes proposed for the band",
    )
    run.add_argument(
        "--inputs",
        default="",
        metavar="A,B",
        help="inputs of the model; default: all excited inputs",
    )
    run.add_argument(
        "--outputs",
        default="",
        metavar="A,B",
        help="outputs of the model; default: all usable outputs",
    )
    run.add_argument("--free", metavar="A,B", help="derivatives to estimate; default: all")
    run.add_argument(
        "--extra-parameters",
        dest="extra_parameters",
        default="",
        metavar="A,B",
        help="further free parameters: delay_q, scale_alpha, omega_7 and so on",
    )
    run.add_argument(
        "--free-delays", action="store_true", help="estimate the delay of every output"
    )
    run.add_argument("--start", choices=_STARTS, default=_STARTS[0], help="starting values")
    run.add_argument(
        "--prior-spread",
        type=float,
        metavar="SHARE",
        help="prior standard deviation of derivatives about the prediction, relative to their size",
    )
    run.add_argument(
        "--additional-maneuvers",
        dest="additional_maneuver_ids",
        default="",
        metavar="ID,ID",
        help="additional maneuvers, estimated jointly with common derivatives",
    )
    run.add_argument("--band", metavar="LOW,HIGH", help="frequencies to use [Hz]; default: all")
    run.add_argument(
        "--wait",
        action="store_true",
        help="execute the run now, instead of queueing it for a server",
    )

    search = add("search", _search, "determine the model structure from maneuvers")
    search.add_argument("maneuvers", metavar="ID,ID", help="ids of maneuvers, searched jointly")
    search.add_argument("--method", choices=_METHODS, default="EE")
    search.add_argument("--modes", default="", metavar="M,N", help="numbers of structural modes")
    search.add_argument(
        "--inputs",
        default="",
        metavar="A,B",
        help="inputs of the model; default: all excited inputs",
    )
    search.add_argument(
        "--outputs",
        default="",
        metavar="A,B",
        help="outputs of the model; default: all usable outputs",
    )
    search.add_argument("--free", metavar="A,B", help="candidate derivatives; default: all")
    search.add_argument(
        "--free-delays", action="store_true", help="estimate the delays of the outputs"
    )
    search.add_argument(
        "--algorithm", choices=("stepwise", "orthogonal functions"), default="stepwise"
    )
    search.add_argument(
        "--begin",
        choices=("all", "equation error"),
        default="all",
        help="initial terms for OE and FRE",
    )
    search.add_argument("--f-in", type=float, default=20.0, metavar="F", help="partial F to enter")
    search.add_argument(
        "--f-out", type=float, metavar="F", help="partial F to stay; default: as to enter"
    )
    search.add_argument(
        "--draws",
        type=int,
        default=30,
        metavar="N",
        help="number of resamplings of the frequencies",
    )
    search.add_argument("--validate-on", default="", metavar="ID,ID", help="validation maneuvers")
    search.add_argument("--band", metavar="LOW,HIGH", help="frequencies to use [Hz]; default: all")

    export = add("export", _export, "export a run, its parameters or its model")
    export.add_argument("run", type=int, metavar="RUN", help="id of the run")
    export.add_argument(
        "--output",
        required=True,
        metavar="FILE",
        help=".json: the run with its inputs; .csv: parameters; .mat: the model",
    )

    report = add(
        "report", _report, "write a report of a run, a comparison, a decision or the campaign"
    )
    report.add_argument("kind", choices=("run", "comparison", "decision", "campaign", "template"))
    report.add_argument("ids", nargs="?", metavar="ID,ID", help="ids of runs, or id of a decision")
    report.add_argument(
        "--predictions", default="", metavar="ID,ID", help="ids of predictions in the comparison"
    )
    report.add_argument(
        "--template", metavar="FILE", help="custom template; start from `flexsid report template`"
    )
    report.add_argument("--output", required=True, metavar="FILE", help=".html, or .pdf")

    design = add(
        "design", _design, "design a multisine of Table 1 for minimum relative peak factor"
    )
    design.add_argument("--fta", type=int, required=True, metavar="N", help="number of the row")
    design.add_argument(
        "--duration", type=float, metavar="S", help="default: 24, or 96 for a row of 4T"
    )
    design.add_argument("--rate", type=float, default=100.0, metavar="HZ")
    design.add_argument("--first-harmonic", type=int, default=6, metavar="K")
    design.add_argument(
        "--peak-deg", type=float, default=2.0, metavar="DEG", help="peak amplitude of the body flap"
    )
    design.add_argument("--effort", choices=("quick", "thorough", "patient"), default="thorough")
    design.add_argument("--seed", type=int, default=0)
    design.add_argument(
        "--output",
        required=True,
        metavar="FILE",
        help=".csv, .mat, .h, or .json (parameters of the design)",
    )

    flown = add("flown", _flown, "import flown multisines as designs")
    flown.add_argument(
        "files", nargs="+", metavar="FILE", help="files with samples of exactly one period"
    )
    flown.add_argument("--rate", type=float, required=True, metavar="HZ", help="sampling rate")
    flown.add_argument("--unit", choices=("deg", "rad"), default="deg")
    flown.add_argument("--name", help="name of the design; default: name of the first file")
    flown.add_argument(
        "--separate", action="store_true", help="store every file as a separate design"
    )

    flutter = add("flutter", _flutter, "predict the flutter speed from runs")
    flutter.add_argument("runs", metavar="RUN,RUN", help="ids of succeeded runs")
    flutter.add_argument(
        "--fuel",
        type=float,
        metavar="SHARE",
        help="fuel fraction; default: that of the fastest run",
    )
    flutter.add_argument(
        "--altitude", type=float, metavar="M", help="altitude in the standard atmosphere"
    )
    flutter.add_argument(
        "--others",
        choices=("predicted", "residualized"),
        default="predicted",
        help="unmodelled modes: included from the prediction, or static response only",
    )
    flutter.add_argument(
        "--next", type=float, metavar="M/S", help="airspeed of the next test point"
    )
    return parser


def _design(_settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.predicted_accuracy import design

    return design(arguments)


def _flown(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.predicted_accuracy import import_flown

    return import_flown(settings, arguments)


def _flutter(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.predicted_accuracy import print_flutter_prediction

    return print_flutter_prediction(settings, arguments)


def _report(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.reports import report

    return report(settings, arguments)


def _search(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.structure_search import search

    return search(settings, arguments)


def _serve(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.serve import serve

    return serve(settings, as_json=arguments.json)


def _demo(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.serve import demo, fill

    if not arguments.no_serve:
        return demo(settings, as_json=arguments.json)
    fill(settings, as_json=arguments.json)
    return 0


def _check(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.backup import check

    return check(settings, as_json=arguments.json)


def _backup(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.backup import backup

    return backup(settings, arguments.file, as_json=arguments.json)


def _restore(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.backup import restore

    return restore(settings, arguments.file, as_json=arguments.json)


def _migrate(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.backup import migrate

    return migrate(settings, as_json=arguments.json)


def _import(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.data import import_each_file, import_files

    bring = import_each_file if arguments.each else import_files
    return bring(
        settings,
        arguments.files,
        arguments.mapping,
        arguments.aircraft,
        confirmed=arguments.confirm,
        as_json=arguments.json,
    )


def _run(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.runs import run

    return run(settings, arguments)


def _export(settings: Settings, arguments: argparse.Namespace) -> int:
    from flexsid.cli.data import export

    return export(settings, arguments.run, arguments.output, as_json=arguments.json)


if __name__ == "__main__":
    sys.exit(main())
