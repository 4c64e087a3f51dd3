"""The ``flexsid`` command: reads the arguments, then does one thing.

What a command needs is imported when it runs, so that ``--help`` is instant.
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


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code: 0, 1 for a failure, 2 for bad input."""
    # Before numpy is loaded: one thread each, for the matrices are small and the cores are shared.
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("flexsid").setLevel(logging.INFO)
    asked = sys.argv[1:] if arguments is None else arguments
    as_json = "--json" in asked
    try:
        chosen = _parser().parse_args(asked)
        settings = read_settings()
        if chosen.database is not None:
            settings = replace(settings, database=chosen.database)
        return chosen.command(settings, chosen)
    except FlexsidError as error:
        from flexsid.cli.saying import complain

        complain(error.message, error.code, as_json=as_json)
        return 2 if isinstance(error, BadInput) else 1
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # whoever read along has read enough, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{message}; see {self.prog} --help", code="bad-arguments")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="flexsid", description="Identify flexible aircraft from flight test.")
    parser.add_argument("--version", action="version", version=f"flexsid {flexsid.__version__}")
    commands = parser.add_subparsers(required=True, metavar=None)

    def add(name: str, command: object, words: str) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=words, description=f"{words.capitalize()}.")
        added.add_argument(
            "--database",
            metavar="URL",
            help=f"address of the database; else FLEXSID_DATABASE, else {DEFAULT_DATABASE}",
        )
        added.add_argument("--json", action="store_true", help="answer as JSON")
        added.set_defaults(command=command)
        return added

    add("serve", _serve, "serve the page and the REST interface on this computer")

    demo = add("demo", _demo, "fill an empty workbench with the demonstration campaign, then serve")
    demo.add_argument("--no-serve", action="store_true", help="stop after filling")

    add("migrate", _migrate, "bring the database to the current schema, after a backup copy")

    add("check", _check, "look for damage in the database: hashes, references, decisions")

    copy = add("backup", _backup, "copy the database into a new file, while servers use it")
    copy.add_argument("file", metavar="FILE")

    back = add("restore", _restore, "put a backup in place of the database, copying that first")
    back.add_argument("file", metavar="FILE")

    bring = add("import", _import, "read files through a mapping")
    bring.add_argument("files", nargs="+", metavar="FILE", help="recorder file or table")
    bring.add_argument(
        "--mapping", metavar="TOML", help="names channels, units and roles; not for known forms"
    )
    bring.add_argument(
        "--aircraft", type=int, metavar="ID", help="whose, where the mapping names none"
    )
    bring.add_argument(
        "--confirm", action="store_true", help="what the mapping marks as guessed is right"
    )
    bring.add_argument(
        "--each", action="store_true", help="every file is an import of its own: a campaign"
    )

    run = add("run", _run, "estimate from maneuvers")
    run.add_argument(
        "--maneuver", required=True, metavar="ID,ID", help="each is estimated on its own"
    )
    run.add_argument("--method", choices=_METHODS, required=True)
    run.add_argument(
        "--structure",
        metavar="ID[:VERSION]",
        help="a saved model structure; default: as described below, else what is proposed",
    )
    run.add_argument(
        "--modes",
        metavar="M,N",
        help="numbers of structural modes, '' for none; default: those proposed for the band",
    )
    run.add_argument("--inputs", default="", metavar="A,B", help="default: all that moved")
    run.add_argument(
        "--outputs", default="", metavar="A,B", help="default: all that a model can use"
    )
    run.add_argument("--free", metavar="A,B", help="derivatives to estimate; default: all")
    run.add_argument(
        "--also-free", default="", metavar="A,B", help="delay_q, scale_alpha, omega_7 and the like"
    )
    run.add_argument("--free-delays", action="store_true", help="free the delay of every output")
    run.add_argument("--start", choices=_STARTS, default=_STARTS[0], help="where to start from")
    run.add_argument(
        "--prior-spread",
        type=float,
        metavar="SHARE",
        help="hold derivatives near the prediction, within this share of their size",
    )
    run.add_argument(
        "--together-with", default="", metavar="ID,ID", help="maneuvers with the same derivatives"
    )
    run.add_argument("--band", metavar="LOW,HIGH", help="frequencies to use [Hz]; default: all")
    run.add_argument(
        "--wait", action="store_true", help="carry it out now, instead of leaving it to a server"
    )

    search = add("search", _search, "choose the terms of a model by what maneuvers ask for")
    search.add_argument("maneuvers", metavar="ID,ID", help="maneuvers to search over together")
    search.add_argument("--method", choices=_METHODS, default="EE")
    search.add_argument("--modes", default="", metavar="M,N", help="numbers of structural modes")
    search.add_argument("--inputs", default="", metavar="A,B", help="default: all that moved")
    search.add_argument("--outputs", default="", metavar="A,B", help="default: all usable")
    search.add_argument("--free", metavar="A,B", help="candidate derivatives; default: all")
    search.add_argument("--free-delays", action="store_true", help="free the outputs' delays too")
    search.add_argument(
        "--algorithm", choices=("stepwise", "orthogonal functions"), default="stepwise"
    )
    search.add_argument(
        "--begin", choices=("all", "equation error"), default="all", help="OE and FRE begin with"
    )
    search.add_argument("--f-in", type=float, default=20.0, metavar="F", help="to enter")
    search.add_argument("--f-out", type=float, metavar="F", help="to stay; default: as to enter")
    search.add_argument("--draws", type=int, default=30, metavar="N", help="of the lines")
    search.add_argument(
        "--validate-on", default="", metavar="ID,ID", help="maneuvers that are only predicted"
    )
    search.add_argument("--band", metavar="LOW,HIGH", help="frequencies to use [Hz]; default: all")

    export = add("export", _export, "write a run with everything it rests on")
    export.add_argument("run", type=int, metavar="RUN", help="id of the run")
    export.add_argument(
        "--output",
        required=True,
        metavar="FILE",
        help=".json: everything; .csv: parameters; .mat: the model",
    )

    report = add("report", _report, "write a report of runs, a decision or the campaign")
    report.add_argument("kind", choices=("run", "comparison", "decision", "campaign", "template"))
    report.add_argument("ids", nargs="?", metavar="ID,ID", help="of runs, or of a decision")
    report.add_argument("--predictions", default="", metavar="ID,ID", help="beside the runs")
    report.add_argument(
        "--template", metavar="FILE", help="page of your own; start from `flexsid report template`"
    )
    report.add_argument("--output", required=True, metavar="FILE", help=".html, or .pdf")

    design = add("design", _design, "design a multisine of Table 1 for least relative peak factor")
    design.add_argument("--fta", type=int, required=True, metavar="N", help="number of its row")
    design.add_argument(
        "--duration", type=float, metavar="S", help="default: 24, or 96 for a row of 4T"
    )
    design.add_argument("--rate", type=float, default=100.0, metavar="HZ")
    design.add_argument("--first-harmonic", type=int, default=6, metavar="K")
    design.add_argument(
        "--peak-deg", type=float, default=2.0, metavar="DEG", help="of the body flap"
    )
    design.add_argument("--effort", choices=("quick", "thorough", "patient"), default="thorough")
    design.add_argument("--seed", type=int, default=0)
    design.add_argument(
        "--output", required=True, metavar="FILE", help=".csv, .mat, .h, or .json: the recipe"
    )

    flown = add("flown", _flown, "recognise multisines that were flown and keep them as designs")
    flown.add_argument("files", nargs="+", metavar="FILE", help="samples of exactly one period")
    flown.add_argument("--rate", type=float, required=True, metavar="HZ", help="of the samples")
    flown.add_argument("--unit", choices=("deg", "rad"), default="deg")
    flown.add_argument("--name", help="of the design; default: the first file's")
    flown.add_argument("--apart", action="store_true", help="every file is a design of its own")

    flutter = add("flutter", _flutter, "say where runs see the aircraft lose stability")
    flutter.add_argument("runs", metavar="RUN,RUN", help="ids of runs that succeeded")
    flutter.add_argument("--fuel", type=float, metavar="SHARE", help="default: the fastest point's")
    flutter.add_argument("--altitude", type=float, metavar="M", help="standard atmosphere")
    flutter.add_argument(
        "--others",
        choices=("predicted", "residualized"),
        default="predicted",
        help="modes the runs left out: carried as predicted, or their static response only",
    )
    flutter.add_argument("--next", type=float, metavar="M/S", help="airspeed of the next point")
    return parser


def _design(_settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.foresight import design

    return design(chosen)


def _flown(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.foresight import keep_flown

    return keep_flown(settings, chosen)


def _flutter(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.foresight import foretell

    return foretell(settings, chosen)


def _report(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.reports import report

    return report(settings, chosen)


def _search(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.searching import search

    return search(settings, chosen)


def _serve(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.serve import serve

    return serve(settings, as_json=chosen.json)


def _demo(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.serve import demo, fill

    if not chosen.no_serve:
        return demo(settings, as_json=chosen.json)
    fill(settings, as_json=chosen.json)
    return 0


def _check(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.keeping import check

    return check(settings, as_json=chosen.json)


def _backup(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.keeping import backup

    return backup(settings, chosen.file, as_json=chosen.json)


def _restore(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.keeping import restore

    return restore(settings, chosen.file, as_json=chosen.json)


def _migrate(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.keeping import migrate

    return migrate(settings, as_json=chosen.json)


def _import(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.data import bring_in, bring_in_each

    bring = bring_in_each if chosen.each else bring_in
    return bring(
        settings,
        chosen.files,
        chosen.mapping,
        chosen.aircraft,
        confirmed=chosen.confirm,
        as_json=chosen.json,
    )


def _run(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.runs import run

    return run(settings, chosen)


def _export(settings: Settings, chosen: argparse.Namespace) -> int:
    from flexsid.cli.data import export

    return export(settings, chosen.run, chosen.output, as_json=chosen.json)


if __name__ == "__main__":
    sys.exit(main())
