"""Signed files: each changed byte is noticed, and so are changes before the file was signed."""

from __future__ import annotations

import json
import stat

import numpy as np
import orjson
import pytest

from flexsid.errors import BadInput
from flexsid.storage.database import Database
from flexsid.storage.signatures import SignaturePlace, read_public_key, sign_content
from flexsid.workflow.maintenance.printed_reports import check_signed_file

CONTENTS = {
    SignaturePlace.COMMENT: b"<!doctype html>\n<p>CZ_alpha = -4.6 \xc2\xb1 0.1\n",
    SignaturePlace.PDF: b"%PDF-1.7\n1 0 obj\n%%EOF\n",
    SignaturePlace.JSON: b'{"run":{"id":1,"value":-4.6},"signature":null}',
    SignaturePlace.INDENTED_JSON: b'{\n  "run": 1,\n  "signature": null\n}',
}


@pytest.fixture
def site(tmp_path) -> Database:
    return Database(f"sqlite:///{tmp_path}/site.db")


@pytest.mark.parametrize("place", SignaturePlace)
def test_every_changed_byte_of_a_signed_file_is_noticed(site: Database, place: SignaturePlace):
    signed = sign_content(site, CONTENTS[place], place)
    assert check_signed_file(signed, read_public_key(site)).key == read_public_key(site)
    if place in (SignaturePlace.JSON, SignaturePlace.INDENTED_JSON):
        assert isinstance(json.loads(signed)["signature"], str)
    rng = np.random.default_rng(1)
    # In the content, and in the signature and the text about it.
    places = [
        *rng.integers(len(CONTENTS[place]), size=12),
        *range(len(signed) - 140, len(signed), 11),
    ]
    for number in places:
        changed = bytearray(signed)
        changed[number] ^= 1 << int(rng.integers(8))
        with pytest.raises(BadInput):
            check_signed_file(bytes(changed))
    for shorter in (signed[:-1], signed[1:], signed + b"\n", b""):
        with pytest.raises(BadInput):
            check_signed_file(shorter)


def test_the_key_is_made_once_and_private(site: Database, tmp_path):
    key = read_public_key(site)
    assert key == read_public_key(Database(f"sqlite:///{tmp_path}/site.db"))
    assert stat.S_IMODE((tmp_path / "site.db-site-key").stat().st_mode) == 0o600
    other = Database(f"sqlite:///{tmp_path}/other.db")
    signed = sign_content(site, CONTENTS[SignaturePlace.PDF], SignaturePlace.PDF)
    with pytest.raises(BadInput) as refused:
        check_signed_file(signed, read_public_key(other))
    assert refused.value.code == "wrong-site-key"


def test_a_site_on_a_database_server_signs_with_a_file_for_its_key(tmp_path):
    address = "postgresql://user@host/flexsid"
    unsigned = CONTENTS[SignaturePlace.PDF]
    assert sign_content(Database(address), unsigned, SignaturePlace.PDF) == unsigned
    site = Database(address, site_key=tmp_path / "key")
    signed = sign_content(site, unsigned, SignaturePlace.PDF)
    assert check_signed_file(signed, read_public_key(site)).key == read_public_key(site)
    with pytest.raises(BadInput, match="FLEXSID_SITE_KEY"):
        read_public_key(Database(address, site_key=tmp_path / "none" / "key"))


def test_a_decision_changed_before_it_was_signed_is_noticed(site: Database):
    event = {"data": {}, "previous_hash": "", "sealed": "{}", "hash": "0" * 64, "data_hash": ""}
    trail = {"decisions": [{"decision": {"id": 3}, "events": [event]}], "signature": None}
    signed = sign_content(site, orjson.dumps(trail), SignaturePlace.JSON)
    with pytest.raises(BadInput, match="decision 3"):
        check_signed_file(signed)
