"""The ``flexsid`` command: parses the arguments and dispatches to one command.

Each command imports its modules when it runs, so that others are fast. The commands of analyses are
listed by the kinds of jobs, which take longest to load.
"""

from __future__ import annotations

import argparse
import logging
import os
import pkgutil
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, NoReturn

import flexsid
from flexsid.cli.output import discard_output, flush_output, print_error
from flexsid.errors import BadInput, FlexsidError
from flexsid.jobs.messages import loading

if TYPE_CHECKING:
    from flexsid.settings import Settings

_MODAL_ACTIONS = (
    *("inspect", "import", "list", "modes", "correlate", "orthogonality", "update", "export"),
    *("mass", "responses", "identify"),
)
_METHODS = ("OE", "FRE", "EE")
_ROLES = ("viewer", "analyst", "reviewer", "admin")


def main(command_line: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code: 0, 1 for a failure, 2 for bad input."""
    # Before numpy is imported: one BLAS thread, since the matrices are small and cores are shared.
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    # Processes that this one starts import from the installation only.
    os.environ.pop("PYTHONPATH", None)
    os.environ["PYTHONSAFEPATH"] = "1"
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("flexsid").setLevel(logging.INFO)
    given = sys.argv[1:] if command_line is None else command_line
    as_json = "--json" in given
    try:
        code = _call(lambda: _run(given), as_json=as_json)
        return _call(flush_output, as_json=as_json) or code
    except BrokenPipeError:  # the reader has closed the pipe, as `head` does
        discard_output()
        return 141


def _run(given: Sequence[str]) -> int:
    arguments = build_parser(*given[:1]).parse_args(given)
    from flexsid.settings import read_settings

    settings = read_settings()
    if arguments.database is not None:
        settings = settings.model_copy(update={"database": arguments.database})
    return _load_command(arguments.command)(settings, arguments)


def _call(action: Callable[[], int], *, as_json: bool) -> int:
    try:
        return action()
    except FlexsidError as error:
        print_error(error.message, error.code, as_json=as_json)
        return 2 if isinstance(error, BadInput) else 1
    except SystemExit as end:  # of --help and --version, and of a server that cannot start
        return end.code if isinstance(end.code, int) else 0
    except KeyboardInterrupt:
        return 130


def _load_command(name: str) -> Callable[[Settings, argparse.Namespace], int]:
    with loading():
        command: Callable[[Settings, argparse.Namespace], int]
        command = pkgutil.resolve_name(f"flexsid.cli.{name}")
        return command


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise BadInput(f"{message}; see {self.prog} --help", code="bad-arguments")


def build_parser(only: str | None = None) -> argparse.ArgumentParser:
    """Return the parser of all commands; ``command`` names the function to call.

    With ``only`` one command, others lack the options that the class of their request states:
    these classes take long to load.
    """
    parser = _Parser(prog="flexsid", description="Identify flexible aircraft from flight test.")
    parser.add_argument("--version", action="version", version=f"flexsid {flexsid.__version__}")
    if only == "--version":
        return parser
    with loading():
        from flexsid.settings import DEFAULT_DATABASE
    commands = parser.add_subparsers(required=True, metavar=None)

    def add(
        name: str,
        command: str,
        summary: str,
        add_options: Callable[[argparse.ArgumentParser], None] = lambda command: None,
    ) -> argparse.ArgumentParser:
        added = commands.add_parser(name, help=summary, description=f"{summary.capitalize()}.")
        added.add_argument(
            "--database",
            metavar="URL",
            help=f"URL of the database; default: FLEXSID_DATABASE, else {DEFAULT_DATABASE}",
        )
        added.add_argument("--json", action="store_true", help="print the result as JSON")
        added.set_defaults(command=command)
        if only in (None, name):
            with loading():
                add_options(added)
        return added

    add("serve", "serve:serve", "serve the page and the REST interface on this computer")

    summary = "serve, and fill an empty workbench with the demonstration campaign"
    demo = add("demo", "serve:demo", summary)
    demo.add_argument("--no-serve", action="store_true", help="fill only")
    meaning = "fly FLEX-28U, whose air forces lag the motion, in place of FLEX-28"
    demo.add_argument("--unsteady", action="store_true", help=meaning)

    summary = "upgrade the database to the current schema, after a backup copy"
    add("migrate", "administration:migrate", summary)

    summary = "check the database for damage: hashes, references, decisions"
    check = add("check", "administration:check", summary)
    meaning = "take changed rows as they are, after they were inspected and corrected"
    check.add_argument("--accept-rows", action="store_true", help=meaning)
    meaning = "report lost transactions that were found no longer"
    check.add_argument("--accept-losses", action="store_true", help=meaning)

    summary = "check a signed file, or the installation against published values"
    _add_verify_options(add("verify", "verify:verify", summary))

    summary = "write a run with its data, settings and results as an RO-Crate"
    capsule = add("capsule", "verify:export", summary)
    capsule.add_argument("run", type=int, metavar="RUN", help="id of a run that succeeded")
    meaning = "file; default: flexsid-run-RUN.crate.zip"
    capsule.add_argument("--output", metavar="FILE", help=meaning)

    summary = "compute the run of a capsule again, and compare the results"
    recompute = add("recompute", "verify:recompute", summary)
    recompute.add_argument("file", metavar="FILE", help="capsule of a run")
    meaning = "public key of the site that the capsule must be of"
    recompute.add_argument("--key", metavar="HEX", help=meaning)

    summary = "add, invite and disable accounts, and set their roles in campaigns"
    _add_user_options(add("users", "administration:users", summary))

    summary = "write the configuration of a Dask cluster, with a new key and certificate"
    certificate = add("cluster-certificate", "serve:write_certificate", summary)
    meaning = "new file; scheduler, workers and servers name it by DASK_CONFIG"
    certificate.add_argument("file", metavar="FILE", help=meaning)

    summary = "serve what a workbench reads and proposes as tools for agents (MCP)"
    agents = add("mcp", "live:serve_tools", summary)
    meaning = "address of the workbench; its token is that of FLEXSID_TOKEN"
    agents.add_argument("--url", default="http://127.0.0.1:8000", metavar="URL", help=meaning)
    meaning = "name under which it proposes, where the workbench has no accounts"
    agents.add_argument("--analyst", default="", metavar="NAME", help=meaning)

    summary = "start, show and stop streams of a running workbench while an aircraft flies"
    _add_live_options(add("live", "live:run_action", summary))

    audit = add("audit", "administration:audit", "export the audit log: who changed what, and when")
    audit.add_argument("--output", required=True, metavar="FILE", help="JSON, one event per line")

    summary = "back up the database into a new file, while servers use it"
    copied = add("backup", "administration:backup", summary)
    copied.add_argument("file", metavar="FILE")
    meaning = "FILE is a folder: restore the copy as a test, and retain the newest N made so"
    copied.add_argument("--retained", type=int, metavar="N", help=meaning)
    meaning = "repeat at this interval until stopped, an hour after a failure"
    copied.add_argument("--every", type=int, metavar="HOURS", help=meaning)
    meaning = "with --retained: write only samples that are not in the folder, into samples.db"
    copied.add_argument("--incremental", action="store_true", help=meaning)

    summary = "replace the database by a backup, after a copy of the database"
    add("restore", "administration:restore", summary).add_argument("file", metavar="FILE")

    aircraft = add("aircraft", "data:define_aircraft", "add an aircraft before its first flight")
    meaning = "TOML: the [aircraft] part of a mapping"
    aircraft.add_argument("file", metavar="FILE", help=meaning)
    meaning = "correct this aircraft instead"
    aircraft.add_argument("--replace", type=int, metavar="ID", help=meaning)

    _add_import_options(add("import", "data:import_files", "import files with a mapping"))
    summary = "import, compare, update and export modes of FEM and ground vibration tests"
    _add_modal_options(add("modal-data", "modal_data:run_action", summary))
    add("run", "runs:run", "estimate from maneuvers", _add_run_options)
    summary = "list, save or delete templates: settings of runs under a name"
    _add_template_options(add("template", "runs:templates", summary))

    predict = add("predict", "models:predict", "compute derivatives from a planform")
    meaning = "TOML: aircraft_id, source, panels or deck_file, surfaces, mach, reference_k"
    predict.add_argument("file", metavar="FILE", help=meaning)

    summary = "determine the model structure from maneuvers"
    add("search", "models:search", summary, _add_search_options)

    export = add("export", "data:export", "export a run, its parameters or its model")
    export.add_argument("run", type=int, metavar="RUN", help="id of the run")
    meaning = (
        ".json: the run with its inputs; .csv: parameters; .mat, .fmu: the model; .zip: JSBSim"
    )
    export.add_argument("--output", required=True, metavar="FILE", help=meaning)
    meaning = "version of FMI of an .fmu file"
    export.add_argument("--fmi", choices=("2", "3"), default="2", help=meaning)
    meaning = "run of the other axis in an aircraft for JSBSim"
    export.add_argument("--other-run", type=int, metavar="RUN", help=meaning)

    samples = add("samples", "data:export_samples", "export the samples of a maneuver, in SI units")
    samples.add_argument("maneuver", type=int, metavar="MANEUVER", help="id of the maneuver")
    meaning = "names of channels or combinations; default: all recorded channels"
    samples.add_argument("--channels", metavar="A,B", help=meaning)
    meaning = ".csv; .json; .mat: structures for Simulink; .nc: NetCDF for xarray"
    samples.add_argument("--output", required=True, metavar="FILE", help=meaning)

    summary = "print identified derivatives and open warnings of a campaign"
    campaign = add("dashboard", "reports:dashboard", summary)
    meaning = "id of the aircraft; default: 1"
    campaign.add_argument(
        "aircraft", type=int, nargs="?", default=1, metavar="AIRCRAFT", help=meaning
    )

    summary = "write a report of a run, a comparison, flutter, a decision or the campaign"
    add("report", "reports:report", summary, _add_report_options)

    summary = "design a multisine of Table 1 for minimum relative peak factor"
    _add_design_options(add("design", "excitation:design", summary))

    summary = "optimise a design for an objective within limits"
    add("optimal-design", "excitation:optimise_design", summary, _add_optimal_design_options)

    summary = "import flown multisines as designs"
    _add_multisine_options(add("import-multisine", "excitation:import_multisine", summary))

    summary = "predict the flutter speed from runs"
    add("flutter", "models:predict_flutter", summary, _add_flutter_options)
    summary = "fit derivatives over the envelope to all runs, and name outlying runs"
    add("global-model", "reports:fit_global_model", summary, _add_global_model_options)
    summary = "predict maneuvers by runs, or held-out data by refits of runs"
    add("validate", "models:validate", summary, _add_validation_options)
    summary = "fit a model of one's own, state-space matrices of a Python function"
    _add_grey_box_options(add("grey-box", "grey_box:fit_grey_boxes", summary))
    summary = "write the posterior of a run back into modal table and prediction, or undo it"
    _add_write_back_options(add("write-back", "write_backs:run_write_back", summary))
    summary = "compare the sensors of maneuvers by kinematics, and name faults"
    _add_compatibility_options(add("compatibility", "data:check_compatibility", summary))
    summary = "take the corrections of the causes that rejected runs name"
    meaning = "ids of runs that their tests reject"
    add("correct", "data:correct_causes", summary).add_argument(
        "runs", metavar="RUN,RUN", help=meaning
    )
    summary = "test whether one linear model holds at the amplitudes of several runs"
    _add_amplitude_options(add("amplitudes", "models:compare_amplitudes", summary))
    if only not in commands.choices:
        with loading():
            from flexsid.cli.analyses import list_commands
            from flexsid.cli.options import add_request
        for name, summary, analysis in list_commands():
            options = partial(add_request, request=analysis.request)
            add(name, "analyses:run_analysis", summary, options).set_defaults(analysis=analysis)
    return parser


def _add_amplitude_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    meaning = (
        "ids of succeeded output-error runs of maneuvers with one multisine at several levels; "
        "default: list the repeated levels of the campaign"
    )
    option("runs", nargs="?", default="", metavar="RUN,RUN", help=meaning)
    meaning = "id of the aircraft whose levels are listed; default: 1"
    option("--aircraft", type=int, default=1, metavar="ID", help=meaning)


def _add_user_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    actions = ("add", "reset", "disable", "grant", "revoke", "list", "adopt")
    meaning = (
        "add an account; reset its password; disable it; grant or revoke a role; list accounts;"
        " adopt records without a campaign into that of the aircraft NAME"
    )
    option("action", choices=actions, help=meaning)
    option("name", nargs="?", default="", metavar="NAME", help="name of the account")
    option("role", nargs="?", choices=_ROLES, help="role in the campaign")
    meaning = "name of the aircraft of the campaign; default: all campaigns"
    option("--campaign", default="all", metavar="NAME", help=meaning)


def _add_import_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    option("files", nargs="+", metavar="FILE", help="recorder file or table")
    meaning = "names channels, units and roles; not needed for recognised formats"
    option("--mapping", metavar="TOML", help=meaning)
    option("--aircraft", type=int, metavar="ID", help="aircraft, if the mapping names none")
    meaning = "confirm the values that the mapping marks as guessed"
    option("--confirm", action="store_true", help=meaning)
    option("--each", action="store_true", help="import every file as its own maneuver")


def _add_model_options(command: argparse.ArgumentParser, modes: str, free: str) -> None:
    option = command.add_argument
    meaning = "longitudinal, lateral, or longitudinal-airspeed for long records"
    option("--axis", metavar="AXIS", help=f"axis of the model: {meaning}; default: the maneuver's")
    option("--modes", metavar="M,N", help=f"numbers of structural modes{modes}")
    meaning = "inputs of the model; default: all excited inputs"
    option("--inputs", default="", metavar="A,B", help=meaning)
    meaning = "outputs of the model; default: all usable outputs"
    option("--outputs", default="", metavar="A,B", help=meaning)
    option("--free", metavar="A,B", help=f"{free}; default: all")
    option("--free-delays", action="store_true", help="estimate the delay of every output")
    option("--band", metavar="LOW,HIGH", help="frequencies to use [Hz]; default: all")


def _add_write_back_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    meaning = "id of the run; without --reason, what would be written; default: list write-backs"
    option("run", type=int, nargs="?", metavar="RUN", help=meaning)
    option("--reason", metavar="TEXT", help="write it back, for this reason")
    meaning = "undo this write-back: the former versions are the default again"
    option("--undo", type=int, metavar="ID", help=meaning)


def _add_grey_box_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    option("--maneuver", required=True, metavar="ID,ID", help="ids of maneuvers, each fitted alone")
    meaning = "file that defines a GreyBox, or the name of an installed model"
    option("--model", required=True, metavar="FILE.py", help=meaning)
    option("--method", choices=("OE", "FRE"), default="OE", help="estimator; default: OE")
    option("--band", metavar="LOW,HIGH", help="frequencies to use [Hz]; default: all excited")


def _add_compatibility_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    meaning = "ids of maneuvers of one aircraft and recorder, compared together"
    option("--maneuver", required=True, metavar="ID,ID", help=meaning)
    option("--each", action="store_true", help="compare each maneuver separately")
    meaning = "correct the faults of samples in all maneuvers of the aircraft"
    option("--correct", action="store_true", help=meaning)


def _add_run_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.records.run import RunSettings

    option = command.add_argument
    meaning = "ids of maneuvers, each estimated separately"
    option("--maneuver", required=True, metavar="ID,ID", help=meaning)
    option("--method", choices=_METHODS, required=True)
    meaning = "saved model structure; default: the options below, else the proposed structure"
    option("--structure", metavar="ID[:VERSION]", help=meaning)
    modes = ", '' for none; default: the modes proposed for the band"
    _add_model_options(command, modes, "derivatives to estimate")
    meaning = "further free parameters: delay_q, scale_alpha, omega_7 and so on"
    option("--extra-parameters", default="", metavar="A,B", help=meaning)
    meaning = "template of runs, by name or id, whose settings hold unless they are given here"
    option("--template", metavar="NAME", help=meaning)
    names = ("start", "start_run_id", "max_iterations", "noise", "prior_spread")
    names += ("out_of_band_modes", "aerodynamics", "additional_maneuver_ids")
    add_options(command, RunSettings, *names)
    meaning = "execute the run now, instead of queueing it for a server"
    option("--wait", action="store_true", help=meaning)


def _add_live_options(command: argparse.ArgumentParser) -> None:
    command.add_argument("action", choices=("receivers", "start", "list", "show", "stop"))
    command.add_argument("stream", type=int, nargs="?", metavar="STREAM", help="id of a stream")
    meaning = "address of the workbench; its token is that of FLEXSID_TOKEN"
    command.add_argument("--url", default="http://127.0.0.1:8000", metavar="URL", help=meaning)
    command.add_argument("--analyst", default="", metavar="NAME", help="name of the analyst")
    meaning = "run whose model, channels and settings the stream has"
    command.add_argument("--run", type=int, metavar="RUN", help=meaning)
    command.add_argument("--receiver", metavar="NAME", help="where samples come from")
    meaning = "option of the receiver, such as subject=flight5 or channels.q=ATTITUDE.pitchspeed"
    command.add_argument(
        "--option", action="append", default=[], metavar="NAME=VALUE", help=meaning
    )
    command.add_argument("--title", metavar="TITLE", help="title on the page")
    command.add_argument("--flight", type=int, metavar="ID", help="flight to store maneuvers in")
    meaning = "airspeed of the next test point [m/s]"
    command.add_argument("--next", type=float, metavar="V", help=meaning)


def _add_modal_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    option("action", choices=_MODAL_ACTIONS)
    meaning = (
        "files to inspect or import; ids of modal tables, or of measured responses to identify; for"
        " orthogonality the id, then files"
    )
    option("items", nargs="*", metavar="ITEM", help=meaning)
    option("--aircraft", type=int, default=1, metavar="ID", help="aircraft; default: 1")
    option("--name", metavar="NAME", help="name of the modal table")
    option("--kind", choices=("FEM", "GVT"), default="FEM")
    option("--length", choices=("m", "mm", "in", "ft"), help="unit of length of the files")
    option("--mass", choices=("kg", "t", "lb", "slug", "slinch"), help="unit of mass")
    option("--generalized-mass", choices=("file", "unit", "unknown"))
    meaning = "directions of x, y and z of the files"
    option("--axes", default="aft right up", metavar="AXES", help=meaning)
    meaning = "fuel fraction; of files FILE=0,FILE=1"
    option("--fuel", metavar="FRACTION", help=meaning)
    option("--analysis", action="append", default=[], metavar="FILE=LABEL")
    option("--rigid-modes", action="store_true", help="include rigid-body modes")
    option("--other", type=int, metavar="ID", help="second table of an orthogonality")
    option("--other-fuel", type=float, metavar="FRACTION", help="fuel of the second table")
    option("--matrix", metavar="NAME", help="mass matrix in the files")
    option("--stiffness", metavar="NAME", help="stiffness matrix, to reduce the mass")
    option("--tests", default="", metavar="ID,ID", help="tests that a table is updated from")
    option("--runs", default="", metavar="ID,ID", help="runs that a table is updated from")
    meaning = ".uff, .csv, .mat, .op4; .zip: all fuel weights; .svg: a picture"
    option("--output", metavar="FILE", help=meaning)
    meaning = "uff-single, op4-binary, or the form of the files of an archive"
    option("--form", metavar="FORM", help=meaning)
    option("--mode", type=int, metavar="NUMBER", help="mode of a picture")
    option("--moving", action="store_true", help="animate the picture")
    option("--response-unit", metavar="UNIT", help="unit of responses, where no file states it")
    option("--force-unit", choices=("N", "lbf"), help="unit of forces, where no file states it")
    option("--frequency-unit", choices=("Hz", "rad/s"))
    option("--phase-unit", choices=("deg", "rad"))
    option("--time-unit", choices=("s", "ms"))
    meaning = "number of averages: estimate frequency responses from time data"
    option("--averages", type=int, metavar="N", help=meaning)
    option("--estimator", choices=("H1", "H2", "Hv"), default="H1")
    meaning = "share of a block that the next one repeats; default: 0.5"
    option("--overlap", type=float, default=0.5, metavar="SHARE", help=meaning)
    option("--window", choices=("hann", "rectangular"), default="hann")
    option("--low", type=float, metavar="HZ", help="begin of the band of identified modes")
    option("--high", type=float, metavar="HZ", help="end of the band of identified modes")
    option("--order", type=int, default=40, help="highest model order; default: 40")
    meaning = "numbers of poles of the stabilisation diagram that are fitted; default: automatic"
    option("--poles", default="", metavar="N,N", help=meaning)


def _add_template_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    option("action", choices=("list", "save", "delete"))
    option("name", nargs="?", metavar="NAME", help="name of the template; to delete, or its id")
    option("--run", type=int, metavar="ID", help="run whose method and settings are saved")
    option("--note", default="", metavar="TEXT", help="what the template is for")


def _add_search_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.records.search import SearchSettings

    option = command.add_argument
    option("maneuvers", metavar="ID,ID", help="ids of maneuvers, searched jointly")
    option("--method", choices=_METHODS, default="EE")
    _add_model_options(command, "", "candidate derivatives")
    names = ("algorithm", "initial_terms", "f_in", "pse_noise", "resamplings", "validate_on")
    add_options(command, SearchSettings, *names, "max_iterations", "noise")
    meaning = "partial F to stay; default: as to enter"
    option("--f-out", type=float, default=argparse.SUPPRESS, metavar="F", help=meaning)


def _add_report_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.workflow.flutter.flutter_analysis import FlutterQuery

    option = command.add_argument
    kinds = ("run", "comparison", "flutter", "closed-loop", "decision", "global-model", "sortie")
    option("kind", choices=(*kinds, "campaign", "figure", "template"))
    meaning = (
        "ids of runs, or id of a decision, of a version of a global model or of a stream, or the "
        "address of a figure: 'bode?maneuver_id=1&output=q'"
    )
    option("ids", nargs="?", metavar="ID,ID", help=meaning)
    meaning = "ids of predictions in the comparison"
    option("--predictions", default="", metavar="ID,ID", help=meaning)
    option("--controller", type=int, metavar="ID", help="controller of a closed loop")
    add_options(command, FlutterQuery, "fuel", "next_m_s")
    meaning = "units of the report: metric with deg and g, US customary, or SI with rad"
    option("--units", choices=("metric", "us", "si"), help=meaning)
    meaning = "unit of frequencies in the report"
    option("--frequency-unit", choices=("Hz", "rad/s"), help=meaning)
    for name, meaning in (("width-mm", "width"), ("height-mm", "height"), ("font-pt", "font")):
        help_text = f"{meaning} of a figure [{name[-2:]}]; by default across a page of a paper"
        option(f"--{name}", type=float, metavar=name[-2:].upper(), help=help_text)
    option("--title", help="title above a figure")
    meaning = "custom template; start from `flexsid report template`"
    option("--template", metavar="FILE", help=meaning)
    option("--output", required=True, metavar="FILE", help=".html, or .pdf")


def _add_design_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    option("--fta", type=int, required=True, metavar="N", help="number of the row")
    option("--duration", type=float, metavar="S", help="default: 24, or 96 for a row of 4T")
    option("--rate", type=float, default=100.0, metavar="HZ")
    option("--first-harmonic", type=int, default=6, metavar="K")
    meaning = "peak amplitude of the body flap"
    option("--peak-deg", type=float, default=2.0, metavar="DEG", help=meaning)
    meaning = "peak amplitude of throttles, of their full range"
    option("--throttle-percent", type=float, metavar="PERCENT", help=meaning)
    option("--effort", choices=("quick", "thorough", "patient"), default="thorough")
    option("--seed", type=int, default=0)
    meaning = ".csv, .mat, .h, or .json (parameters of the design)"
    option("--output", required=True, metavar="FILE", help=meaning)


def _add_optimal_design_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.records.excitation import DEFAULT_LEVEL
    from flexsid.workflow.excitation.optimal_designs import Objective, OptimalDesignQuery

    option = command.add_argument
    option("design", type=int, metavar="DESIGN", help="id of the standard design")
    option("run", type=int, metavar="RUN", help="id of the output-error run with model and noise")
    option("--objective", choices=list(map(str, Objective)), default=str(Objective.FLUTTER))
    meaning = f"amplitude of the design; default: {DEFAULT_LEVEL}"
    option("--level", type=int, choices=(0, 1, 2), default=argparse.SUPPRESS, help=meaning)
    names = ("derivatives", "mode", "other_run_id", "load_factor", "spread", "after_run")
    add_options(command, OptimalDesignQuery, *names)
    option("--deflection-deg", type=float, metavar="DEG", help="default: that of the design")
    option("--rate-deg-s", type=float, metavar="DEG/S", help="default: that of the design")


def _add_multisine_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    meaning = "files with samples of exactly one period"
    option("files", nargs="+", metavar="FILE", help=meaning)
    option("--rate", type=float, required=True, metavar="HZ", help="sampling rate")
    option("--unit", choices=("deg", "rad"), default="deg")
    option("--name", help="name of the design; default: name of the first file")
    option("--separate", action="store_true", help="store every file as a separate design")


def _add_flutter_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.workflow.flutter.flutter_analysis import FlutterQuery

    option = command.add_argument
    meaning = (
        "ids of succeeded runs; default: those of the approved global model, and its variation"
    )
    option("runs", nargs="?", metavar="RUN,RUN", help=meaning)
    meaning = "id of the aircraft of the approved global model; default: 1"
    option("--aircraft", type=int, default=1, metavar="ID", help=meaning)
    option("--axis", choices=("longitudinal", "lateral"), default="longitudinal")
    names = ("fuel", "altitude_m", "unmodelled_modes", "next_m_s", "variation")
    add_options(command, FlutterQuery, *names)


def _add_verify_options(command: argparse.ArgumentParser) -> None:
    option = command.add_argument
    meaning = "report, audit trail or exported run; default: test the installation"
    option("file", nargs="?", metavar="FILE", help=meaning)
    option("--key", metavar="HEX", help="public key of the site that the file must be of")
    option("--site-key", action="store_true", help="print the public key of this site")
    meaning = "report of the installation; default: flexsid-verification.html"
    option("--output", default="flexsid-verification.html", metavar="FILE", help=meaning)


def _add_global_model_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.workflow.global_model.estimates import GlobalModelQuery

    option = command.add_argument
    meaning = "ids of succeeded runs of one model structure; default: list the stored versions"
    option("runs", nargs="?", metavar="RUN,RUN", help=meaning)
    meaning = "store the model as the next version, to be proposed for approval"
    option("--store-version", metavar="LABEL", help=meaning)
    option("--note", default="", metavar="TEXT", help="note of the stored version")
    add_options(command, GlobalModelQuery, "variables", "prediction_id")
    meaning = "write DAVE-ML with standard errors and check cases to a file"
    option("--dave-ml", metavar="FILE", help=meaning)
    option("--fmu", metavar="FILE", help="write an FMU of the derivatives over the envelope")
    option("--fmi", choices=("2", "3"), default="2", help="version of FMI of the FMU")
    meaning = "store the derivatives at one condition as a prediction of this name"
    option("--store-prediction", metavar="NAME", help=meaning)
    meaning = "value of every variable, in SI; default: mean condition of the runs"
    option("--condition", nargs="+", type=float, default=(), metavar="VALUE", help=meaning)


def _add_validation_options(command: argparse.ArgumentParser) -> None:
    from flexsid.cli.options import add_options
    from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
    from flexsid.workflow.validation.cross_validation import CrossValidationQuery

    option = command.add_argument
    option("runs", metavar="RUN,RUN", help="ids of succeeded runs")
    add_options(command, CrossPredictionQuery, "maneuver_ids")
    meaning = (
        "fit each run again without held-out data and predict these: all folds of the frequencies, "
        "the first fold, or the last periods"
    )
    option("--hold-out", choices=("folds", "frequencies", "periods"), help=meaning)
    add_options(command, CrossValidationQuery, "folds")


if __name__ == "__main__":
    sys.exit(main())
