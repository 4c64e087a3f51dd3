"""Replaced words do not return."""

from __future__ import annotations

from pathlib import Path

import pytest
from vocabulary import ROOT, checked_files, find_words, read_vocabulary


def test_replaced_words_do_not_return() -> None:
    vocabulary = read_vocabulary()
    found = [
        f"{path.relative_to(ROOT)}:{line}: {word!r}; use: {new}"
        for path in checked_files()
        for line, word, new in find_words(path.read_text(), vocabulary)
    ]
    assert not found, f"{len(found)} replaced words:\n" + "\n".join(found[:50])


@pytest.mark.parametrize("word", ["keep", "say", "owner", "question", "answer", "chosen"])
def test_plain_english_is_not_replaced(word: str) -> None:
    assert find_words(f"{word} {word}s", read_vocabulary()) == []


def test_a_replaced_word_is_found_in_prose_and_in_names(tmp_path: Path) -> None:
    file = tmp_path / "vocabulary.txt"
    file.write_text(
        "foretold: predicted\nleft out: omitted\n`as_flown`: flight noise\nallow: isForetold\n"
    )
    vocabulary = read_vocabulary(file)
    text = "Flutter is foretold.\nwasForetold = left_out()\nas_flown.isForetold\n"
    assert find_words(text, vocabulary) == [
        (1, "foretold", "predicted"),
        (2, "foretold", "predicted"),
        (2, "left out", "omitted"),
        (3, "as_flown", "flight noise"),
    ]
