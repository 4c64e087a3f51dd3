"""Notifier: sends what concerns an account by mail or to a web hook, each message once.

It is a thread of the dispatcher that has the lease: no request waits, and of several servers one
sends. A message is marked as sent before, so that one that a killed server may have sent is not
sent again; one that was refused is tried again for a day.
"""

from __future__ import annotations

import json
import logging
import smtplib
import ssl
import threading
import tomllib
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from email.message import EmailMessage
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from ipaddress import ip_address
from pathlib import Path
from typing import Any
from urllib.parse import SplitResult, urlsplit

import sqlalchemy as sa

from flexsid.errors import BadInput, FlexsidError
from flexsid.storage.store import Store
from flexsid.storage.tables import decision_events
from flexsid.workflow.review.notifications import Message, list_messages, mark_sent, mark_unsent

_log = logging.getLogger(__name__)

_POLL_S = 2.0
_RETRY_S = 60.0  # after a message that was refused
_TIMEOUT_S = 20.0  # of a connection
_TRIED = timedelta(days=1)
_MAIL_PORTS = {"smtp": 587, "smtps": 465}

# --- The file with mail server, addresses of accounts, and web hook -------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Mail:
    """A mail server, the address of the sender, and those of accounts by name."""

    server: SplitResult
    sender: str
    addresses: dict[str, str]
    user: str = ""
    password: str = field(default="", repr=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Channels:
    """Where messages are sent; the address of a web hook is a secret."""

    mail: Mail | None = None
    hook: SplitResult | None = field(default=None, repr=False)


def read_channels(file: Path) -> Channels:
    """Read the file of ``FLEXSID_NOTIFICATIONS``.

    Raises
    ------
    BadInput
        If it cannot be read, or has something else; its contents are not cited.
    """
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a TOML file"
        raise _refuse(file, f"cannot be read: {reason}") from None
    if not content or not content.keys() <= {"mail", "hook"}:
        raise _refuse(file, "needs tables [mail] or [hook], and nothing else")
    hook = content.get("hook")
    if hook is not None and (not _has_texts(hook, {"url"}, {"url"})):
        raise _refuse(file, "needs in [hook] the text url alone")
    return Channels(
        mail=_read_mail(file, content["mail"]) if "mail" in content else None,
        hook=None if hook is None else _read_address(file, hook["url"], "http", "https"),
    )


def _read_mail(file: Path, table: Any) -> Mail:
    addresses = table.pop("addresses", None) if isinstance(table, dict) else None
    known = {"server", "from", "user", "password"}
    if not _has_texts(table, {"server", "from"}, known) or ("user" in table) != (
        "password" in table
    ):
        raise _refuse(file, "needs in [mail] server and from, and user and password or none")
    if not isinstance(addresses, dict) or not _has_texts(addresses, set(), set(addresses)):
        raise _refuse(file, "needs a table [mail.addresses] of addresses by name of account")
    if not all(_is_mail_address(one) for one in (table["from"], *addresses.values())):
        raise _refuse(file, "has in from or [mail.addresses] what is no address like ann@abc.org")
    return Mail(
        server=_read_address(file, table["server"], "smtp", "smtps"),
        sender=table["from"],
        addresses={name.casefold(): address for name, address in addresses.items()},
        user=table.get("user", ""),
        password=table.get("password", ""),
    )


def _has_texts(table: Any, least: set[str], most: set[str]) -> bool:
    is_texts = isinstance(table, dict) and all(isinstance(one, str) for one in table.values())
    return is_texts and least <= table.keys() <= most


def _is_mail_address(text: str) -> bool:
    name, _, host = text.partition("@")
    return bool(name and host) and text.isascii() and not set(text) & set(" \r\n,;<>")


def _read_address(file: Path, text: str, plain: str, encrypted: str) -> SplitResult:
    try:
        parts = urlsplit(text)
        is_address = bool(parts.hostname) and parts.username is None and parts.port != 0
    except ValueError:
        raise _refuse(file, f"has no address like {encrypted}://example.org") from None
    if not is_address or parts.scheme not in (plain, encrypted):
        raise _refuse(file, f"has no address like {encrypted}://example.org")
    if parts.scheme == "http" and not _is_loopback(parts.hostname or ""):
        raise _refuse(file, "has a hook beyond the loopback address without https://")
    return parts


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _refuse(file: Path, reason: str) -> BadInput:
    message = f"FLEXSID_NOTIFICATIONS is {file}, which {reason}"
    return BadInput(message, code="bad-notifications")


# --- Sending --------------------------------------------------------------------------------------


class Notifier:
    """Sends messages while this server dispatches.

    Parameters
    ----------
    store
        Store of the decisions.
    channels
        Where messages are sent.
    url
        Address of the server in a browser.
    is_leading
        Returns whether this server has the lease.
    """

    def __init__(
        self, store: Store, channels: Channels, url: str, is_leading: Callable[[], bool]
    ) -> None:
        self._store = store
        self._channels = channels
        self._url = url
        self._is_leading = is_leading
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name="notifier", daemon=True)
        self.failure = ""  # of the last round

    def start(self) -> None:
        """Start sending."""
        self._thread.start()

    def stop(self) -> None:
        """Send no further message; one that is being sent ends with the process."""
        self._stopping.set()

    def _run(self) -> None:
        done: int | None = None
        last = 0
        pause_s = _POLL_S
        while not self._stopping.wait(pause_s):
            pause_s = _POLL_S
            try:
                last = self._find_last_event()
                if not self._is_leading() or last == done:
                    continue
                self.failure = "; ".join(sorted(set(self._send_all())))
            except FlexsidError as error:  # of the database
                self.failure = error.message
            except Exception:
                _log.exception("the notifier continues after an error")
                self.failure = "an error, which the log of the server has"
            done, pause_s = (None, _RETRY_S) if self.failure else (last, _POLL_S)

    def _find_last_event(self) -> int:
        with self._store.database.reading() as connection:
            return connection.scalar(sa.select(sa.func.max(decision_events.c.id))) or 0

    def _send_all(self) -> Iterator[str]:
        """Send what is due, and yield the reasons for which messages were refused."""
        mail, hook = self._channels.mail, self._channels.hook
        if mail is not None:
            yield from self._send_by("mail", lambda message: self._send_mail(mail, message))
        if hook is not None:
            yield from self._send_by("hook", lambda message: self._call_hook(hook, message))

    def _send_by(self, channel: str, send: Callable[[Message], None]) -> Iterator[str]:
        for message in list_messages(self._store, channel, datetime.now(UTC) - _TRIED):
            if self._stopping.is_set() or not self._is_leading():
                return
            before = mark_sent(self._store, channel, message)
            try:
                send(message)
            except (OSError, HTTPException) as error:
                if not isinstance(error, _Unconfirmed):
                    mark_unsent(self._store, channel, message, before)
                # The type only: the text of an error may cite the address of a hook.
                reason = f"by {channel} to {message.analyst}: {type(error).__name__}"
                _log.warning("a message was not sent %s", reason)
                yield reason

    def _send_mail(self, mail: Mail, message: Message) -> None:
        address = mail.addresses.get(message.analyst.casefold())
        if address is None:
            return
        letter = EmailMessage()
        letter["From"], letter["To"] = mail.sender, address
        letter["Subject"] = f"flexsid: {message.title}"
        letter.set_content("\n".join([*message.lines, "", self._link(message)]))
        with closing(_open_mail(mail)) as server:
            try:
                server.send_message(letter)
            except (smtplib.SMTPResponseException, smtplib.SMTPRecipientsRefused):
                raise
            except OSError as error:
                raise _Unconfirmed from error
            with suppress(OSError):
                server.quit()

    def _call_hook(self, hook: SplitResult, message: Message) -> None:
        """Post to the stated address alone: neither redirections nor proxies are followed."""
        text = "\n".join([f"{message.title} ({message.analyst})", *message.lines])
        body = {
            "person": message.analyst,
            "title": message.title,
            "text": text,
            "url": self._link(message),
        }
        with closing(_open_hook(hook)) as connection:
            path = (hook.path or "/") + (f"?{hook.query}" if hook.query else "")
            try:
                headers = {"Content-Type": "application/json"}
                connection.request("POST", path, json.dumps(body), headers)
                status = connection.getresponse().status
            except (OSError, HTTPException) as error:
                raise _Unconfirmed from error
        if not 200 <= status < 300:
            raise HTTPException(status)

    def _link(self, message: Message) -> str:
        return f"{self._url}/decisions/{message.decision_id}"


class _Unconfirmed(OSError):
    """A message was sent, but its acceptance not confirmed: a second one might double it."""


def _open_mail(mail: Mail) -> smtplib.SMTP:
    host, context = mail.server.hostname or "", ssl.create_default_context()
    port = mail.server.port or _MAIL_PORTS[mail.server.scheme]
    if mail.server.scheme == "smtps":
        server: smtplib.SMTP = smtplib.SMTP_SSL(host, port, timeout=_TIMEOUT_S, context=context)
    else:
        server = smtplib.SMTP(host, port, timeout=_TIMEOUT_S)
    try:
        if mail.server.scheme == "smtp" and not _is_loopback(host):
            server.starttls(context=context)
        if mail.user:
            server.login(mail.user, mail.password)
    except BaseException:
        server.close()
        raise
    return server


def _open_hook(hook: SplitResult) -> HTTPConnection:
    host = hook.hostname or ""
    if hook.scheme == "https":
        context = ssl.create_default_context()
        connection = HTTPSConnection(host, hook.port, timeout=_TIMEOUT_S, context=context)
    else:
        connection = HTTPConnection(host, hook.port, timeout=_TIMEOUT_S)
    connection.connect()
    return connection
