"""The vocabulary of the project: replaced words and their occurrences."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
VOCABULARY = ROOT / "vocabulary.txt"
CHECKED = {".py", ".md", ".ts", ".tsx", ".css", ".html", ".toml"}
# Migrations, their test and the changelog contain former names; the rest is installed or generated.
EXCLUDED = {
    *("node_modules", ".venv", ".git", ".cache", "dist", "frontend_dist", "var", "versions"),
    *(
        "schema.gen.ts",
        "CHANGELOG.md",
        "vocabulary.txt",
        "vocabulary.py",
        "test_vocabulary.py",
        "sealed_names.py",
        "test_migrations.py",
    ),
}
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
_NAME = re.compile(r"[A-Za-z_][\w-]*")


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """Replacements by phrase (words in lower case) and by name, and allowed names."""

    phrases: dict[tuple[str, ...], str]
    names: dict[str, str]
    allowed: frozenset[str]


def read_vocabulary(path: Path = VOCABULARY) -> Vocabulary:
    """Read ``old, old: new`` lines."""
    phrases: dict[tuple[str, ...], str] = {}
    names: dict[str, str] = {}
    allowed: set[str] = set()
    for line in path.read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        old, _, new = line.partition(": ")
        for entry in old.split(", "):
            if entry == "allow":
                allowed.update(new.split(", "))
            elif entry.startswith("`"):
                names[entry.strip("`")] = new
            else:
                phrases[tuple(entry.split())] = new
    return Vocabulary(phrases, names, frozenset(allowed))


def checked_files(folder: Path = ROOT) -> Iterator[Path]:
    """Text files of the project below a folder, or the file itself."""
    if folder.is_file():
        yield folder
    for inner, folders, files in os.walk(folder):
        folders[:] = sorted(set(folders) - EXCLUDED)
        for name in sorted(set(files) - EXCLUDED):
            if Path(name).suffix in CHECKED:
                yield Path(inner, name)


def find_words(text: str, vocabulary: Vocabulary) -> list[tuple[int, str, str]]:
    """Return replaced words: line number, word, and replacement."""
    longest = max(map(len, vocabulary.phrases))
    found: list[tuple[int, str, str]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.endswith("# earlier name"):  # of what was stored, which is read for ever
            continue
        words: list[str] = []
        for name in _NAME.findall(line):
            if name in vocabulary.names:
                found.append((number, name, vocabulary.names[name]))
            if name in vocabulary.allowed:
                words.append("")
            else:
                words += [word.lower() for word in _WORD.findall(name)]
        for place in range(len(words)):
            for length in range(1, longest + 1):
                phrase = tuple(words[place : place + length])
                if len(phrase) == length and phrase in vocabulary.phrases:
                    found.append((number, " ".join(phrase), vocabulary.phrases[phrase]))
    return found
