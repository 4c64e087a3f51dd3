"""A wrong variable of the environment is named with its value and what is right."""

from __future__ import annotations

import os

import pytest

from flexsid.errors import BadInput
from flexsid.settings import Mode, Settings, list_variables, read_settings


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("PORT", "eighty", "is 'eighty'; expected a port number from 1 to 65535"),
        ("PORT", "8_0", "is '8_0'; expected a port number from 1 to 65535"),
        ("WORKERS", "0", "is '0'; expected a number of processes from 1 to 256"),
        ("PORT", "65536", "is '65536'; expected a port number from 1 to 65535"),
        (
            "UPLOAD_GIGABYTES",
            "nan",
            "is 'nan'; expected a number of gigabytes from 0.001 to 999999",
        ),
        ("MODE", "x", "is 'x'; expected one of personal, team, organisation"),
        ("BACKUPS_INCREMENTAL", "1", "is '1'; expected yes or no"),
        ("ADDRESS", "here", "is 'here'; expected an IP address"),
        ("URL", "http://[::1", "is 'http://[::1'; expected an address like https://flexsid."),
        ("DASK", "tls://[::1", "is 'tls://[::1'; expected an address like tls://127.0.0.1:8786"),
        ("PROXIES", "::1, x", "has 'x'; expected an IP address, or a network such as 10.0.0.0/24"),
        ("BROKERS", "nats://a, nats://u:pw@b:1", "has 'b:1'; expected addresses such as nats://"),
        ("OIDC_ISSUER", "id.example", "is 'id.example'; expected an https:// address"),
    ],
)
def test_a_wrong_variable_is_named_with_what_is_right(name: str, value: str, expected: str) -> None:
    with pytest.raises(BadInput) as refused:
        read_settings({f"FLEXSID_{name}": value})
    assert refused.value.message.startswith(f"FLEXSID_{name} {expected}")


def test_empty_variables_are_unset_and_unknown_ones_are_not_read() -> None:
    empty = {name: "" for name, *_ in list_variables()}
    assert read_settings({**empty, "FLEXSID_NONE": "1", "flexsid_port": "1"}) == Settings()


def test_every_default_of_the_table_is_what_an_unset_variable_means() -> None:
    written = {name: default for name, _, _, default in list_variables() if default}
    assert len(written) > 8
    assert read_settings(written) == Settings()


def test_streams_of_a_team_connect_to_listed_brokers_only() -> None:
    assert read_settings({}).brokers is None
    assert read_settings({"FLEXSID_MODE": "team"}).brokers == ()
    listed = {"FLEXSID_MODE": "team", "FLEXSID_BROKERS": "nats://a.example, tls://b.example:4222"}
    assert read_settings(listed).brokers == ("nats://a.example", "tls://b.example:4222")


def test_only_reading_takes_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FLEXSID_MODE", "team")
    assert Settings().mode is Mode.PERSONAL
    assert read_settings(os.environ).mode is Mode.TEAM
