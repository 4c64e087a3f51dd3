"""Kind of analysis that a deck, or its echo in a printout, states."""

from __future__ import annotations

import re
from collections.abc import Iterable

MODES, BUCKLING, FLUTTER = "modes", "buckling", "flutter"

_NUMBERED = r"^\s*(?:\d+\s+)?"  # as the echo of a deck is
_SOLUTION = re.compile(rf"{_NUMBERED}SOL\s*=?\s*(\w+)\s*(?:$|[,$])", re.IGNORECASE)
_BY_SOLUTION = {
    **dict.fromkeys(("3", "103", "SEMODES", "SEMODE"), MODES),
    **dict.fromkeys(("107", "110", "SEDCEIG", "SEMCEIG"), MODES),
    **dict.fromkeys(("5", "105", "SEBUCKL"), BUCKLING),
    **dict.fromkeys(("145", "SEFLUTTR", "SEFLUTTER"), FLUTTER),
}
_CARDS = tuple(
    (re.compile(_NUMBERED + entry, re.IGNORECASE), kind)
    for entry, kind in (
        (r"ANALYSIS\s*=\s*BUCK", BUCKLING),
        (r"PARAM[\s,]+BUCKLE[\s,]+[12]", BUCKLING),
        (r"EIGB\*?(?:\s*,|\s+\d)", BUCKLING),
        (r"ANALYSIS\s*=\s*(?:MODES|MCEIG|DCEIG)", MODES),
        (r"ANALYSIS\s*=\s*FLUT", FLUTTER),
        (r"FMETHOD\s*=", FLUTTER),
        (r"(?:AERO|FLUTTER|FLFACT)\*?(?:\s*,|\s+\d)", FLUTTER),
    )
)
_WORD = re.compile(r"B U C K L I N G|\bBUCKLING\b", re.IGNORECASE)
_CANDIDATE = re.compile(
    r"SOL|BUCK|B U C K|EIGB|ANALYSIS|FMETHOD|AERO|FLUTTER|FLFACT", re.IGNORECASE
)
"""Text of every line of interest."""

ROW_OF_NUMBERS = re.compile(r" [-+. \dDEG]*")
"""A row of a table; no heading has these letters alone. A printout may have a million of them."""


def find_solution(lines: Iterable[str]) -> str:
    """Return the kind of analysis that lines of a deck or printout state; empty if they do not.

    A solution sequence without several analyses decides; else entries of case control and bulk
    data do (SOL 106 with PARAM,BUCKLE, SOL 200), and buckling before others. Titles count where
    neither states the kind.
    """
    sequence, by_card, is_named = "", set[str](), False
    for line in lines:
        if ROW_OF_NUMBERS.fullmatch(line) or _CANDIDATE.search(line) is None:
            continue
        if (found := _SOLUTION.match(line)) is not None:
            sequence = sequence or _BY_SOLUTION.get(found[1].upper(), "")
        by_card |= {kind for pattern, kind in _CARDS if pattern.match(line)}
        is_named = is_named or _WORD.search(line) is not None
    if sequence:
        return sequence
    by_word = BUCKLING if is_named else ""
    return next((kind for kind in (BUCKLING, FLUTTER, MODES) if kind in by_card), by_word)
