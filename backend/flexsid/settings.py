"""Settings from environment variables.

A field of ``Settings`` is the one declaration of a variable, whose name is ``FLEXSID_`` and that of
the field in capitals: its type, range, default and meaning. Errors name what is expected by it,
and the page of the documentation on variables is printed from it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from enum import StrEnum
from ipaddress import ip_address, ip_network
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import urlsplit

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError
from pydantic_settings import (
    BaseSettings,
    EnvSettingsSource,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
)

from flexsid.errors import BadInput
from flexsid.records.account import NAME_CLAIM, OpenIdProvider

DEFAULT_DATABASE = "sqlite:///var/flexsid.db"
_PREFIX = "FLEXSID_"
_SHORTEST_SECRET = 32
_LEAST_LETTERS = 8
"""Least number of different characters in a secret."""
_WIDEST_NETWORK = {4: 8, 6: 32}
"""Least length of the prefix of a network of proxies, by version of the protocol."""


class Mode(StrEnum):
    """Who may use a server; settled when it starts."""

    PERSONAL = "personal"  # whoever uses this computer, without log-in
    TEAM = "team"  # accounts in the database
    ORGANISATION = "organisation"  # accounts that the organisation authenticates


# --- Kinds of values: what they are, and how their text is read -----------------------------------


def _split(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    return tuple(part.strip() for part in value.split(",") if part.strip())


def _read_switch(value: Any) -> Any:
    return {"yes": True, "no": False}.get(value, value)


def _check_digits(value: Any) -> Any:
    if isinstance(value, str) and re.fullmatch(r"[0-9]+(\.[0-9]+)?", value, re.ASCII) is None:
        raise ValueError
    return value


def _read_url(text: str) -> str:
    parts = urlsplit(text)
    if parts.scheme not in ("http", "https") or not parts.hostname or parts.path not in ("", "/"):
        raise ValueError
    if parts.username is not None or parts.password is not None:
        raise BadInput("FLEXSID_URL contains a user or a password, which pages would show")
    return f"{parts.scheme}://{parts.netloc.lower()}"


def _check_issuer(text: str) -> str:
    parts = urlsplit(text)
    is_local = _is_loopback(parts.hostname or "")
    if parts.scheme != "https" and not (parts.scheme == "http" and is_local):
        raise ValueError
    return text


def _check_broker(text: str) -> str:
    parts = urlsplit(text)
    has_more = "@" in text or parts.path.strip("/") or parts.query or parts.port == 0
    if not parts.scheme or not parts.hostname or has_more:
        raise ValueError
    return text


def _check_scheduler(text: str) -> str:
    """Check the address of a Dask scheduler, on which whoever connects can run any code."""
    parts = urlsplit(text)
    if parts.scheme not in ("tcp", "tls") or not parts.hostname:
        raise ValueError
    if parts.scheme == "tcp" and not _is_loopback(parts.hostname):
        raise BadInput(
            f"FLEXSID_DASK is {text!r}, a scheduler beyond the loopback address without TLS, on "
            "which whoever connects can run any code; write a certificate by `flexsid "
            "cluster-certificate FILE`, and use tls://"
        )
    return text


def _read_address(text: str) -> str:
    return str(ip_address(text))


def _read_network(text: str) -> str:
    network = ip_network(text)
    if network.prefixlen < _WIDEST_NETWORK[network.version]:
        raise BadInput(
            f"FLEXSID_PROXIES has {text!r}: nearly any client could state who it is; expected the "
            "addresses of proxies, or their network such as 10.0.0.0/24"
        )
    return str(network)


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


_Count = Annotated[int, BeforeValidator(_check_digits)]
_Gigabytes = Annotated[
    float,
    BeforeValidator(_check_digits),
    Field(title="a number of gigabytes", ge=0.001, le=999_999),
]
_Switch = Annotated[bool, BeforeValidator(_read_switch), Field(strict=True, title="yes or no")]
_Networks = Annotated[
    tuple[Annotated[str, AfterValidator(_read_network)], ...], BeforeValidator(_split)
]
_Brokers = Annotated[
    tuple[Annotated[str, AfterValidator(_check_broker)], ...] | None, BeforeValidator(_split)
]


# --- The settings ---------------------------------------------------------------------------------


class Settings(BaseSettings):
    """Address of the database, port of the web server, number of worker processes, access.

    Whoever makes settings states them: only ``read_settings`` reads the environment.
    """

    model_config = SettingsConfigDict(env_prefix=_PREFIX, enable_decoding=False, frozen=True)

    database: str = Field(DEFAULT_DATABASE, description="URL of the database.")
    port: _Count = Field(
        8000, title="a port number", ge=1, le=65535, description="Port to serve on."
    )
    workers: _Count | None = Field(
        None,
        title="a number of processes",
        ge=1,
        le=256,
        description="Worker processes; by default one less than the number of cores.",
    )
    dask: Annotated[str, AfterValidator(_check_scheduler)] | None = Field(
        None,
        title="an address like tls://127.0.0.1:8786",
        description="Dask scheduler whose workers are used instead; `tls://` beyond the loopback "
        "address.",
    )
    report_template: str | None = Field(
        None, description="File with a custom template of reports; by default the built-in one."
    )
    mode: Mode = Field(
        Mode.PERSONAL,
        title=f"one of {', '.join(Mode)}",
        description="No log-in, accounts, or log-in at the OpenID provider of an organisation, "
        "unless a proxy names the user.",
    )
    url: Annotated[str, AfterValidator(_read_url)] | None = Field(
        None,
        title="an address like https://flexsid.example.org",
        description="The server in the browser; by default its address and port.",
    )
    address: Annotated[str, AfterValidator(_read_address)] = Field(
        "127.0.0.1",
        title="an IP address",
        description="Address to listen on; others than loopback need log-in and TLS.",
    )
    proxies: _Networks = Field(
        (),
        title="an IP address, or a network such as 10.0.0.0/24",
        description="Proxies, separated by commas, which state the address of the client.",
    )
    proxy_secret: str | None = Field(
        None,
        repr=False,
        description="Secret that the proxy sends with the user in organisation mode.",
    )
    oidc_issuer: Annotated[str, AfterValidator(_check_issuer)] | None = Field(
        None,
        title="an https:// address",
        description="OpenID provider in organisation mode.",
    )
    oidc_client_id: str | None = Field(None, description="Name of the server at the provider.")
    oidc_client_secret: str | None = Field(
        None, repr=False, description="Secret of the server at the provider."
    )
    oidc_name_claim: str = Field(
        NAME_CLAIM, description="Claim of the provider with the name of the account."
    )
    site_key: Path | None = Field(
        None,
        description="File of the key that signs reports, made at first use; by default beside the "
        "SQLite file, and none on PostgreSQL.",
    )
    credentials: Path | None = Field(
        None, description="File with credentials of brokers of telemetry."
    )
    brokers: _Brokers = Field(
        default_factory=lambda data: None if data["mode"] is Mode.PERSONAL else (),
        title="addresses such as nats://broker.example.org:4222, separated by commas, without "
        "user and password",
        description="Brokers that live streams may connect to without these credentials; by "
        "default any in personal mode, otherwise none.",
    )
    backup_hours: _Count | None = Field(
        None,
        title="a number of hours",
        ge=1,
        le=8760,
        description="Interval of scheduled backups beside the SQLite file; by default none is "
        "made.",
    )
    backups_retained: _Count = Field(
        7,
        title="a number of backups",
        ge=1,
        le=10_000,
        description="Scheduled backups that are retained.",
    )
    backups_incremental: _Switch = Field(
        False,
        description="These backups share one file of samples, to which new ones are added.",
    )
    analyst_jobs: _Count | None = Field(
        None,
        title="a number of jobs",
        ge=1,
        le=10**6,
        description="Unfinished jobs that one analyst may have; by default without limit.",
    )
    campaign_gigabytes: _Count | None = Field(
        None,
        title="a number of gigabytes",
        ge=1,
        le=10**6,
        description="Samples that the recordings of one campaign may have; by default without "
        "limit.",
    )
    expansion: _Count = Field(
        100,
        title="a ratio",
        ge=1,
        le=10**6,
        description="Most content of uploaded files, in their size (1 MB is always allowed).",
    )
    account_upload_gigabytes: _Gigabytes = Field(
        10.0,
        description="Gigabytes that uploads of one account may have until they are imported.",
    )
    upload_gigabytes: _Gigabytes = Field(
        50.0, description="Gigabytes that all uploads may have until they are imported."
    )
    notifications: Path | None = Field(
        None,
        description="File with mail server and web hook by which accounts are notified.",
    )
    recordings: str | None = Field(
        None,
        description="Address of the chunks of long recordings; by default they are in the "
        "database.",
    )

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Return what is given alone, as the source of values."""
        return (init_settings,)

    @property
    def openid(self) -> OpenIdProvider | None:
        """Provider at which users log in."""
        if not (self.oidc_issuer and self.oidc_client_id and self.oidc_client_secret):
            return None
        return OpenIdProvider(
            issuer=self.oidc_issuer,
            client_id=self.oidc_client_id,
            client_secret=self.oidc_client_secret,
            name_claim=self.oidc_name_claim,
        )

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
    """Read the variables ``FLEXSID_...``; unset and empty ones have their defaults.

    Raises
    ------
    BadInput
        If a value is invalid, or would expose data without log-in or encryption.
    """
    source = EnvSettingsSource(Settings)
    source.env_vars = {
        name.lower(): text
        for name, text in environment.items()
        if name.startswith(_PREFIX) and text
    }
    try:
        settings = Settings(**source())
    except ValidationError as error:
        raise BadInput(_explain(error)) from None
    _check_access(settings)
    return settings


def list_variables() -> Iterator[tuple[str, str, str, str]]:
    """Yield name, meaning, values and default of each variable; the last two may be empty."""
    for name, field in Settings.model_fields.items():
        meaning, values = field.description or "", _describe_values(name)
        yield _variable(name), meaning, values, _write(field.default)


def _write(default: Any) -> str:
    """Return a default as the text of a variable; empty if its meaning states it."""
    if isinstance(default, bool):
        return "yes" if default else "no"
    if isinstance(default, float):
        return f"{default:g}"
    return str(default) if isinstance(default, str | int) else ""


def _variable(name: str) -> str:
    return f"{_PREFIX}{name.upper()}"


def _describe_values(name: str) -> str:
    field = Settings.model_fields[name]
    limits = {
        key: getattr(one, key)
        for key in ("ge", "le")
        for one in field.metadata
        if hasattr(one, key)
    }
    span = " from {ge} to {le}".format_map(limits) if limits else ""
    return f"{field.title or ''}{span}"


def _explain(error: ValidationError) -> str:
    """Name the first variable that is wrong, its value without credentials, and what is right."""
    first = error.errors(include_url=False)[0]
    name, *item = first["loc"]
    shown = str(first["input"]).rpartition("@")[2]
    expected = _describe_values(str(name))
    return f"{_variable(str(name))} {'has' if item else 'is'} {shown!r}; expected {expected}"


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
    provider = (settings.oidc_issuer, settings.oidc_client_id, settings.oidc_client_secret)
    if any(provider) and not all(provider):
        raise BadInput(
            "FLEXSID_OIDC_ISSUER, FLEXSID_OIDC_CLIENT_ID and FLEXSID_OIDC_CLIENT_SECRET are set "
            "together"
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
