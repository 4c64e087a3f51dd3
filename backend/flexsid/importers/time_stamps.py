"""Time stamps written as date or time of day, as seconds."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta

_CLOCK = r"(?P<hours>\d{1,2}):(?P<minutes>\d{2}):(?P<seconds>\d{2}(?:[.,:]\d{1,9})?)"
_DATED = re.compile(
    rf"(?P<date>\d{{4}}-\d{{2}}-\d{{2}})[T ]{_CLOCK}\s*(?P<zone>Z|UTC|[+-]\d{{2}}:?\d{{2}})?",
    re.ASCII | re.IGNORECASE,
)
_OF_DAY = re.compile(rf"(?:(?P<day>\d{{1,3}})[:-])?{_CLOCK}\s*(?:Z|UTC)?", re.ASCII | re.IGNORECASE)
_DAY_S = 86_400.0


def parse_time_stamp(cell: str) -> float | None:
    """Return the seconds of a time stamp; None if the text is none.

    Parameters
    ----------
    cell
        Date and time of ISO 8601 (``2025-06-03T14:14:00.125Z``; without a zone it is UTC), time
        of day (``14:14:00.125``), or day of the year and time as written by IRIG time code
        readers (``154:14:14:00.125``).

    Returns
    -------
    float or None
        Seconds since 1970-01-01 UTC for a date, since the begin of the year for a day of the
        year (day 1), and since midnight for a time of day. [s]
    """
    cell = cell.strip()
    dated = _DATED.fullmatch(cell)
    found = dated or _OF_DAY.fullmatch(cell)
    if found is None:
        return None
    seconds = float(re.sub("[,:]", ".", found["seconds"]))
    if (
        int(found["hours"]) > 23 or int(found["minutes"]) > 59 or seconds >= 61.0
    ):  # UTC inserts a 61st
        return None
    of_day = 3600.0 * int(found["hours"]) + 60.0 * int(found["minutes"]) + seconds
    if dated is None:
        day = found["day"]
        if day is not None and not 1 <= int(day) <= 366:
            return None
        return of_day + _DAY_S * (0 if day is None else int(day) - 1)
    try:
        midnight = datetime.fromisoformat(found["date"]).replace(tzinfo=UTC)
    except ValueError:
        return None
    return (midnight - _find_offset(found["zone"])).timestamp() + of_day


def _find_offset(zone: str | None) -> timedelta:
    if zone is None or zone[0] not in "+-":
        return timedelta()
    digits = zone[1:].replace(":", "")
    offset = timedelta(hours=int(digits[:2]), minutes=int(digits[2:]))
    return -offset if zone[0] == "-" else offset
