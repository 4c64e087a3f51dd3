"""Process that simulates the demonstration aircraft while the server runs."""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import closing, suppress
from multiprocessing.connection import Connection
from types import FrameType

from flexsid.demo.campaign import Report
from flexsid.demo.demonstration import add_demonstration
from flexsid.demo.first_sheet import FirstSheet
from flexsid.errors import FlexsidError
from flexsid.jobs.child import Program
from flexsid.jobs.health import PartHealth, PartState
from flexsid.storage.store import Store

_STOP_S = 5.0  # longer than the simulation of one maneuver
_NICE = 19  # runs and pages have priority: the first run of a new user took 64 s, others 5 s


class CampaignProcess:
    """Adds the missing maneuvers of the campaign to a migrated database.

    Parameters
    ----------
    database
        URL of the database.
    report
        Called with the completed fraction and a message after every maneuver.
    unsteady
        True for the campaign of FLEX-28U.
    """

    def __init__(self, database: str, report: Report, *, unsteady: bool = False) -> None:
        self._request = database, unsteady
        self._report = report
        self._program: Program | None = None
        self._thread = threading.Thread(target=self._receive, name="campaign", daemon=True)
        self._health: PartHealth | None = _describe(PartState.STARTING, "starting")

    def start(self) -> None:
        """Start the process."""
        self._program = Program("flexsid.demo.campaign_process")
        self._program.connection.send(self._request)
        self._thread.start()

    def stop(self) -> None:
        """End the process; the next one simulates what is missing then."""
        if self._program is not None:
            self._program.release_lifeline()
            self._thread.join(_STOP_S)
            self._program.kill()
            self._program.close()

    def check_health(self) -> PartHealth | None:
        """Return progress or failure of the simulation; None when the campaign is complete."""
        return self._health

    def _receive(self) -> None:
        program = self._program
        assert program is not None
        with suppress(EOFError, OSError):
            while True:
                fraction, message = program.connection.recv()
                if fraction is None:
                    self._fail(message)
                    return
                self._health = (
                    None
                    if fraction == 1.0
                    else _describe(PartState.STARTING, f"{fraction:.0%}, {message}")
                )
                self._report(fraction, message)
        if self._health is not None:
            self._fail(program.describe_exit())

    def _fail(self, reason: str) -> None:
        text = f"incomplete ({reason}). Start flexsid demo again to add the missing maneuvers"
        self._health = _describe(PartState.DEGRADED, text)


def _describe(state: PartState, text: str) -> PartHealth:
    return PartHealth(
        name="demonstration", state=state, text=f"Simulation of the demonstration campaign: {text}."
    )


def main(arguments: list[str]) -> None:
    """Add the campaign; connection and lifeline are given by file descriptor."""
    if hasattr(os, "nice"):
        os.nice(_NICE)
    connection, lifeline = Connection(int(arguments[0])), int(arguments[1])
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _interrupt_once)
    threading.Thread(target=_interrupt_with, args=(lifeline,), daemon=True).start()
    try:
        database, unsteady = connection.recv()
        with closing(Store.open(database)) as store:
            sheet = None if unsteady else FirstSheet(store)

            def report(fraction: float, message: str) -> None:
                if sheet is not None:
                    sheet.advance()
                connection.send((fraction, message))

            add_demonstration(store, report, unsteady=unsteady)
            if sheet is not None:
                sheet.finish()
    except FlexsidError as error:
        connection.send((None, error.message))
    except (KeyboardInterrupt, EOFError, OSError):
        return


def _interrupt_once(number: int, frame: FrameType | None) -> None:
    # Ctrl-C reaches the whole process group, and the end of the server this process again.
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN)
    raise KeyboardInterrupt


def _interrupt_with(lifeline: int) -> None:
    """Interrupt the main thread when the lifeline closes, so that it ends its own processes."""
    os.read(lifeline, 1)
    os.kill(os.getpid(), signal.SIGINT)


if __name__ == "__main__":
    main(sys.argv[1:])
