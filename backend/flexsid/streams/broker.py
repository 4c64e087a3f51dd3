"""What receivers that subscribe to messages of a broker have in common: address, credentials."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated, ClassVar, Self
from urllib.parse import urlsplit

from pydantic import Field, ValidationInfo, field_validator, model_validator

from flexsid.streams.credentials import NamedCredentials, get_access
from flexsid.streams.receiver import Options

RETRY_S = 1.0
"""Time after which a connection is tried again. [s]"""

PING_S = 2
"""Time without data after which a connection is checked. [s]"""


class BrokerOptions(Options):
    """Address of a broker, and the name of credentials, which replaces them.

    ``ports`` has the usual port of each scheme.
    """

    ports: ClassVar[Mapping[str, int]]
    server: Annotated[
        str,
        Field(
            max_length=300,
            description="Address of the broker, with its port if it is not the usual one.",
        ),
    ]
    credentials: NamedCredentials = Field(
        default="",
        validate_default=True,
        description="Name of credentials in the file FLEXSID_CREDENTIALS of the server.",
    )

    @field_validator("server")
    @classmethod
    def _complete_server(cls, address: str) -> str:
        return complete_address(address, cls.ports)

    @model_validator(mode="after")
    def _check_server(self, info: ValidationInfo) -> Self:
        """Refuse credentials of another broker, and brokers that the server does not list.

        An analyst names the address, which may be one that only the server reaches.
        """
        own = self.credentials.server
        if own:
            if complete_address(own, self.ports) != self.server:
                raise ValueError(f"these credentials are for {own} only")
            return self
        listed = get_access(info).brokers
        if listed is not None and self.server not in _complete_all(listed, self.ports):
            raise ValueError(
                f"this server does not connect to {self.server}, which neither FLEXSID_BROKERS "
                "nor the credentials named here list"
            )
        return self


def _complete_all(addresses: Collection[str], ports: Mapping[str, int]) -> set[str]:
    """Return the addresses of these schemes with their ports."""
    return {complete_address(one, ports) for one in addresses if urlsplit(one).scheme in ports}


def complete_address(address: str, ports: Mapping[str, int]) -> str:
    """Return the address of a broker with its port.

    Parameters
    ----------
    address
        Such as ``nats://broker.example.org``.
    ports
        Usual port of each scheme.

    Raises
    ------
    ValueError
        If the scheme is another one, or the address has more than host and port. The address is
        not cited: it may have a password.
    """
    example = f"expected one like {next(iter(ports))}://broker.example.org"
    if "@" in address:
        raise ValueError(f"{example}; name credentials by the option 'credentials'")
    parts = urlsplit(address)
    if parts.scheme not in ports or not parts.hostname or parts.path.strip("/") or parts.query:
        raise ValueError(f"{example}; schemes are {', '.join(ports)}")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    return f"{parts.scheme}://{host}:{parts.port or ports[parts.scheme]}"
