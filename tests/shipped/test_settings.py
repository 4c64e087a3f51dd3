"""The command refuses settings that would publish data without log-in."""

from __future__ import annotations

from pathlib import Path

import pytest
from shipped import run_command

ORGANISATION = {"FLEXSID_MODE": "organisation", "FLEXSID_PROXIES": "127.0.0.1"}


@pytest.mark.parametrize(
    ("variables", "named"),
    [
        ({"FLEXSID_URL": "https://flexsid.example.org"}, "personal mode has no log-in"),
        ({"FLEXSID_URL": "https://ann:secret@flexsid.example.org"}, "a user or a password"),
        ({**ORGANISATION, "FLEXSID_PROXY_SECRET": "a" * 64}, "different characters"),
        ({"FLEXSID_MODE": "team", "FLEXSID_PROXIES": "0.0.0.0/0"}, "nearly any client"),
        ({"FLEXSID_MODE": "team", "FLEXSID_PROXIES": "::/0"}, "nearly any client"),
        ({"FLEXSID_NOTIFICATIONS": "/nowhere"}, "needs accounts"),
        ({"FLEXSID_REPORT_TEMPLATE": "/nowhere"}, "the report template /nowhere cannot be read"),
    ],
)
def test_settings_that_would_publish_data_are_refused(
    tmp_path: Path, variables: dict[str, str], named: str
) -> None:
    done = run_command(tmp_path, f"sqlite:///{tmp_path / 'new.db'}", "serve", **variables)
    assert done.returncode == 2, done.stderr
    assert named in done.stderr
    assert "secret" not in done.stderr.replace("FLEXSID_PROXY_SECRET", "")
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "new.db").exists()
