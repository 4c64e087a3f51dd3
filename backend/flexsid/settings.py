"""Settings from environment variables."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from ipaddress import ip_address, ip_network
from pathlib import Path
from urllib.parse import urlsplit

from flexsid.errors import BadInput
from flexsid.records.account import NAME_CLAIM, OpenIdProvider

DEFAULT_DATABASE = "sqlite:///var/flexsid.db"
DEFAULT_PORT = 8000
LOOPBACK = "127.0.0.1"
_SHORTEST_SECRET = 32
_LEAST_LETTERS = 8
"""Least number of different characters in a secret."""
_WIDEST_NETWORK = {4: 8, 6: 32}
"""Least length of the prefix of a network of proxies, by version of the protocol."""
_BACKUPS_RETAINED = 7
_EXPANSION = 100
_ACCOUNT_UPLOAD_GIGABYTES, _UPLOAD_GIGABYTES = 10.0, 50.0


class Mode(StrEnum):
    """Who may use a server; settled when it starts."""

    PERSONAL = "personal"  # whoever uses this computer, without log-in
    TEAM = "team"  # accounts in the database
    ORGANISATION = "organisation"  # accounts that the organisation authenticates


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Address of the database, port of the web server, number of worker processes, access.

    ``dask`` is the address of a scheduler; without it ``workers`` local
    processes compute (None: one less than the number of cores). Reports use the file
    ``report_template``. With accounts the server is known to browsers as ``url``, and listens on
    ``address``; ``proxies`` may state the client of a request, and with ``proxy_secret`` its user,
    unless users log in at the provider ``openid``. The file ``site_key`` signs what a site on a
    database server issues. Every ``backup_hours`` the database is backed up (None: never), and
    ``backups_retained`` of these backups are retained; they share their samples if
    ``backups_incremental``. The file ``receiver_credentials`` has the
    credentials of brokers of telemetry; other brokers that streams may connect to are ``brokers``
    (None: any). An analyst may have ``analyst_jobs`` unfinished jobs, and
    the recordings of a campaign ``campaign_gigabytes`` (None: no limit). Long recordings of whole
    flights are in chunks at the address ``recordings`` (None: in the database). The content of
    uploaded files is at most ``expansion`` times as large as they are. Uploads that are not
    imported take ``account_upload_gigabytes`` of an account, and ``upload_gigabytes`` in all.
    The file ``notifications`` has the mail server and web hook of messages to accounts.
    """

    database: str = DEFAULT_DATABASE
    port: int = DEFAULT_PORT
    dask: str | None = None
    workers: int | None = None
    report_template: str | None = None
    mode: Mode = Mode.PERSONAL
    url: str | None = None
    address: str = LOOPBACK
    proxies: tuple[str, ...] = ()
    proxy_secret: str | None = field(default=None, repr=False)
    openid: OpenIdProvider | None = None
    site_key: Path | None = None
    backup_hours: int | None = None
    backups_retained: int = _BACKUPS_RETAINED
    backups_incremental: bool = False
    analyst_jobs: int | None = None
    campaign_gigabytes: int | None = None
    receiver_credentials: Path | None = None
    brokers: tuple[str, ...] | None = None
    recordings: str | None = None
    expansion: int = _EXPANSION
    account_upload_gigabytes: float = _ACCOUNT_UPLOAD_GIGABYTES
    upload_gigabytes: float = _UPLOAD_GIGABYTES
    notifications: Path | None = None

    @property
    def public_url(self) -> str:
        """Address of the server in a browser."""
        return self.url or f"http://{self.address}:{self.port}"

    @property
    def is_secure(self) -> bool:
        """Whether browsers use TLS, so that cookies are sent encrypted only."""
        return self.url is not None and self.url.startswith("https://")

    def is_proxy(self, peer: str) -> bool:
        """Whether the word of this address on the client of a request is taken."""
        try:
            address = ip_address(peer)
        except ValueError:
            return False
        return any(address in ip_network(proxy) for proxy in self.proxies)


def read_settings(environment: Mapping[str, str] = os.environ) -> Settings:
    """Read the variables ``FLEXSID_...``; unset ones have their defaults.

    Raises
    ------
    BadInput
        If a value is invalid, or would expose data without log-in or encryption.
    """
    port = _number(environment, "FLEXSID_PORT", "a port number", 65535)
    retained = _number(environment, "FLEXSID_BACKUPS_RETAINED", "a number of backups", 10_000)
    mode = _read_mode(environment.get("FLEXSID_MODE") or Mode.PERSONAL)
    settings = Settings(
        database=environment.get("FLEXSID_DATABASE") or DEFAULT_DATABASE,
        port=DEFAULT_PORT if port is None else port,
        dask=_read_scheduler(environment.get("FLEXSID_DASK") or None),
        workers=_number(environment, "FLEXSID_WORKERS", "a number of processes", 256),
        report_template=environment.get("FLEXSID_REPORT_TEMPLATE") or None,
        mode=mode,
        url=_read_url(environment.get("FLEXSID_URL") or None),
        address=_read_address("FLEXSID_ADDRESS", environment.get("FLEXSID_ADDRESS") or LOOPBACK),
        proxies=tuple(
            _read_network("FLEXSID_PROXIES", part.strip())
            for part in (environment.get("FLEXSID_PROXIES") or "").split(",")
            if part.strip()
        ),
        proxy_secret=environment.get("FLEXSID_PROXY_SECRET") or None,
        openid=_read_openid(environment),
        site_key=Path(key) if (key := environment.get("FLEXSID_SITE_KEY")) else None,
        backup_hours=_number(environment, "FLEXSID_BACKUP_HOURS", "a number of hours", 8760),
        backups_retained=_BACKUPS_RETAINED if retained is None else retained,
        backups_incremental=_read_switch(environment, "FLEXSID_BACKUPS_INCREMENTAL"),
        analyst_jobs=_number(environment, "FLEXSID_ANALYST_JOBS", "a number of jobs", 10**6),
        campaign_gigabytes=_number(
            environment, "FLEXSID_CAMPAIGN_GIGABYTES", "a number of gigabytes", 10**6
        ),
        receiver_credentials=Path(file)
        if (file := environment.get("FLEXSID_CREDENTIALS"))
        else None,
        brokers=_read_brokers(environment, mode),
        recordings=environment.get("FLEXSID_RECORDINGS") or None,
        expansion=_number(environment, "FLEXSID_EXPANSION", "a ratio", 10**6) or _EXPANSION,
        account_upload_gigabytes=_read_gigabytes(
            environment, "FLEXSID_ACCOUNT_UPLOAD_GIGABYTES", _ACCOUNT_UPLOAD_GIGABYTES
        ),
        upload_gigabytes=_read_gigabytes(
            environment, "FLEXSID_UPLOAD_GIGABYTES", _UPLOAD_GIGABYTES
        ),
        notifications=Path(file) if (file := environment.get("FLEXSID_NOTIFICATIONS")) else None,
    )
    _check_access(settings)
    return settings


def _check_access(settings: Settings) -> None:
    """Refuse settings that would expose data."""
    if settings.mode is Mode.PERSONAL and not ip_address(settings.address).is_loopback:
        raise BadInput(
            f"FLEXSID_ADDRESS is {settings.address}, but personal mode has no log-in and is served "
            "on the loopback address only; set FLEXSID_MODE to team or organisation"
        )
    host = urlsplit(settings.url).hostname if settings.url else None
    if settings.mode is Mode.PERSONAL and host is not None and not _is_loopback(host):
        raise BadInput(
            f"FLEXSID_URL is {settings.url}, but personal mode has no log-in: whoever reaches this "
            "address could use the server; set FLEXSID_MODE to team or organisation"
        )
    if settings.mode is Mode.PERSONAL and settings.notifications is not None:
        raise BadInput(
            "FLEXSID_NOTIFICATIONS needs accounts, to whom messages are sent; set FLEXSID_MODE to "
            "team or organisation"
        )
    if not ip_address(settings.address).is_loopback and not settings.is_secure:
        raise BadInput(
            f"FLEXSID_ADDRESS is {settings.address}; beyond the loopback address FLEXSID_URL must "
            "be the https:// address of a proxy with TLS"
        )
    if settings.openid is not None:
        if settings.mode is not Mode.ORGANISATION or settings.proxy_secret is not None:
            raise BadInput(
                "FLEXSID_OIDC_ISSUER needs FLEXSID_MODE=organisation, and no FLEXSID_PROXY_SECRET: "
                "either the provider or a proxy names the user"
            )
        if settings.url is None:
            raise BadInput(
                "FLEXSID_OIDC_ISSUER needs FLEXSID_URL, the address to which the provider returns"
            )
    elif settings.mode is Mode.ORGANISATION and not (settings.proxies and settings.proxy_secret):
        raise BadInput(
            "organisation mode needs FLEXSID_OIDC_ISSUER, the address of the OpenID provider; or "
            "FLEXSID_PROXIES, the addresses of the proxies that name the user, and "
            "FLEXSID_PROXY_SECRET, which they send"
        )
    if settings.proxy_secret is not None and len(settings.proxy_secret) < _SHORTEST_SECRET:
        raise BadInput(
            f"FLEXSID_PROXY_SECRET is shorter than {_SHORTEST_SECRET} characters; make one by "
            "`openssl rand -hex 32`"
        )
    if settings.proxy_secret is not None and len(set(settings.proxy_secret)) < _LEAST_LETTERS:
        raise BadInput(
            f"FLEXSID_PROXY_SECRET has fewer than {_LEAST_LETTERS} different characters; make one "
            "by `openssl rand -hex 32`"
        )


def _read_openid(environment: Mapping[str, str]) -> OpenIdProvider | None:
    issuer = environment.get("FLEXSID_OIDC_ISSUER") or None
    client_id = environment.get("FLEXSID_OIDC_CLIENT_ID") or None
    client_secret = environment.get("FLEXSID_OIDC_CLIENT_SECRET") or None
    if issuer is None and client_id is None and client_secret is None:
        return None
    if issuer is None or client_id is None or client_secret is None:
        raise BadInput(
            "FLEXSID_OIDC_ISSUER, FLEXSID_OIDC_CLIENT_ID and FLEXSID_OIDC_CLIENT_SECRET are set "
            "together"
        )
    parts = urlsplit(issuer)
    is_local = _is_loopback(parts.hostname or "")
    if parts.scheme != "https" and not (parts.scheme == "http" and is_local):
        raise BadInput(f"FLEXSID_OIDC_ISSUER is {issuer!r}; expected an https:// address")
    return OpenIdProvider(
        issuer=issuer,
        client_id=client_id,
        client_secret=client_secret,
        name_claim=environment.get("FLEXSID_OIDC_NAME_CLAIM") or NAME_CLAIM,
    )


def _read_switch(environment: Mapping[str, str], name: str) -> bool:
    text = environment.get(name) or "no"
    if text not in ("yes", "no"):
        raise BadInput(f"{name} is {text!r}; expected yes or no")
    return text == "yes"


def _read_mode(text: str) -> Mode:
    try:
        return Mode(text)
    except ValueError as error:
        raise BadInput(f"FLEXSID_MODE is {text!r}; expected one of {', '.join(Mode)}") from error


def _read_url(text: str | None) -> str | None:
    if text is None:
        return None
    parts = urlsplit(text)
    if parts.scheme not in ("http", "https") or not parts.hostname or parts.path not in ("", "/"):
        raise BadInput(f"FLEXSID_URL is {text!r}; expected one like https://flexsid.example.org")
    if parts.username is not None or parts.password is not None:
        raise BadInput("FLEXSID_URL contains a user or a password, which pages would show")
    return f"{parts.scheme}://{parts.netloc.lower()}"


def _read_brokers(environment: Mapping[str, str], mode: Mode) -> tuple[str, ...] | None:
    """Read the brokers of streams; members of a team name only those that are listed."""
    text = environment.get("FLEXSID_BROKERS")
    if not text and mode is Mode.PERSONAL:
        return None
    brokers = tuple(part.strip() for part in (text or "").split(",") if part.strip())
    for broker in brokers:
        if not _is_broker(broker):
            raise BadInput(
                f"FLEXSID_BROKERS has {broker.rpartition('@')[2]!r}; expected addresses such as "
                "nats://broker.example.org:4222, separated by commas, without user and password"
            )
    return brokers


def _is_broker(text: str) -> bool:
    try:
        parts = urlsplit(text)
        has_more = "@" in text or parts.path.strip("/") or parts.query or parts.port == 0
    except ValueError:  # of the port, or of an IPv6 address
        return False
    return bool(parts.scheme and parts.hostname and not has_more)


def _read_scheduler(text: str | None) -> str | None:
    """Read the address of a Dask scheduler, on which whoever connects can run any code."""
    if text is None:
        return None
    parts = urlsplit(text)
    if parts.scheme not in ("tcp", "tls") or not parts.hostname:
        raise BadInput(f"FLEXSID_DASK is {text!r}; expected one like tls://127.0.0.1:8786")
    if parts.scheme == "tcp" and not _is_loopback(parts.hostname):
        raise BadInput(
            f"FLEXSID_DASK is {text!r}, a scheduler beyond the loopback address without TLS, on "
            "which whoever connects can run any code; write a certificate by `flexsid "
            "cluster-certificate FILE`, and use tls://"
        )
    return text


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _read_address(name: str, text: str) -> str:
    try:
        return str(ip_address(text))
    except ValueError as error:
        raise BadInput(f"{name} has {text!r}; expected an IP address") from error


def _read_network(name: str, text: str) -> str:
    try:
        network = ip_network(text)
    except ValueError as error:
        raise BadInput(
            f"{name} has {text!r}; expected an IP address, or a network such as 10.0.0.0/24"
        ) from error
    if network.prefixlen < _WIDEST_NETWORK[network.version]:
        raise BadInput(
            f"{name} has {text!r}: nearly any client could state who it is; expected the addresses "
            "of proxies, or their network such as 10.0.0.0/24"
        )
    return str(network)


def _read_gigabytes(environment: Mapping[str, str], name: str, default: float) -> float:
    text = environment.get(name) or str(default)
    if re.fullmatch(r"[0-9]{1,6}(\.[0-9]{1,3})?", text, re.ASCII) is None or float(text) == 0.0:
        raise BadInput(f"{name} is {text!r}; expected a number of gigabytes from 0.001 to 999999")
    return float(text)


def _number(environment: Mapping[str, str], name: str, what: str, most: int) -> int | None:
    text = environment.get(name)
    if not text:
        return None
    if not (text.isascii() and text.isdigit() and 0 < int(text[:9]) <= most):
        raise BadInput(f"{name} is {text!r}; expected {what} from 1 to {most}")
    return int(text)
