"""A user relies on: telemetry of a broker arrives, also after the broker was lost."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from brokers import PASSWORD, USER, Broker, MqttBroker, NatsServer

from flexsid.errors import BadInput
from flexsid.records.live import Frame, ReceiverSettings, Reception, StreamChannel, StreamHeader
from flexsid.records.maneuver import Role
from flexsid.streams.broker import BrokerAccess, Credentials, read_credentials
from flexsid.streams.receivers import find_receiver
from flexsid.workflow.live.frame_assembler import encode_frame

HEADER = StreamHeader(
    channels=(
        StreamChannel(name="de", unit="deg", role=Role.INPUT, rate_hz=100.0),
        StreamChannel(name="V", unit="m/s", role=Role.CONDITION, rate_hz=20.0),
    ),
    frame_s=0.05,
)


@pytest.fixture(params=[NatsServer, MqttBroker])
def broker(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Broker]:
    started: Broker = request.param(tmp_path)
    started.start()
    yield started
    started.stop()


def make_packet(number: int) -> bytes:
    samples = (np.full((5, 1), float(number)), np.full((1, 1), 50.0))
    return encode_frame(Frame(number=number, time_s=0.05 * number, samples=samples))


def list_options(broker: Broker, **more: Any) -> dict[str, Any]:
    return {"server": broker.address, broker.place: "flight5", "credentials": "range"} | more


class Received:
    """Numbers of the frames, and the reports, of a source."""

    def __init__(self, broker: Broker, password: str = PASSWORD) -> None:
        own = Credentials(server=broker.address, user=USER, password=password)
        settings = ReceiverSettings(name=broker.scheme, options=list_options(broker))
        receiver, options = find_receiver(settings, BrokerAccess(credentials={"range": own}))
        source = receiver.open(None, options, HEADER)  # type: ignore[arg-type]
        self.items: Any = source.receive(None)
        self.numbers: list[int] = []
        self.reports: list[Reception] = []

    @property
    def last(self) -> Reception:
        return self.reports[-1]

    def until(self, check: Callable[[], object]) -> None:
        """Receive until something is true."""
        while not (self.reports and check()):
            one = next(self.items)
            if isinstance(one, Reception):
                self.reports.append(one)
            else:
                self.numbers.append(one.number)


def test_frames_follow_after_a_lost_broker(broker: Broker, caplog: pytest.LogCaptureFixture):
    caplog.set_level(logging.DEBUG)
    with closing(Received(broker, password="another-secret-55").items) as items:
        # Authorization Violation, Not authorized. A broker that closes the connection at once may
        # reset it before its reason was read; the next attempt follows after a second.
        refused = next(one for one in items if "authori" in one.connection_error.lower())

    received = Received(broker)
    with closing(received.items):
        received.until(lambda: received.last.is_connected)
        broker.publish("other", [make_packet(99)])
        # Of one or several packets; what is no packet is counted and named.
        packets = [make_packet(n) for n in range(6)]
        broker.publish("flight5", [packets[0], b"FXS1 short", packets[1] + packets[2]])
        received.until(lambda: received.numbers == [0, 1, 2] and received.last.rejected == 1)
        assert "10 bytes are not whole packets" in received.last.rejection

        broker.stop()
        received.until(lambda: received.last.is_connected is False)
        assert received.last.connection_error
        broker.start()
        received.until(lambda: received.last.is_connected)
        broker.publish("flight5", packets[4:])
        received.until(lambda: received.numbers == [0, 1, 2, 4, 5])
        assert received.last.interruptions == 1
        assert received.last.interrupted_s > 0.0
        assert received.last.connection_error == ""
    shown = caplog.text + repr(refused) + repr(received.reports)
    assert PASSWORD not in shown
    assert "another-secret-55" not in shown


@pytest.mark.parametrize("kind", [NatsServer, MqttBroker])
def test_invalid_options_are_refused_without_secrets(kind: type[Broker], tmp_path: Path):
    broker = kind(tmp_path)
    known = {"range": Credentials(server=broker.address, user=USER, password=PASSWORD)}
    scheme = broker.scheme
    for change, problem in (
        ({"server": f"{scheme}://{USER}:{PASSWORD}@broker:1"}, "name credentials by the option"),
        ({"server": "http://broker"}, f"expected one like {scheme}://broker.example.org"),
        ({"server": f"{scheme}://broker:99999"}, "Port out of range"),
        ({"server": f"{scheme}://elsewhere"}, "these credentials are for"),
        ({"credentials": "lab"}, "no credentials of this name; the server has range"),
        ({broker.place: "flight *>+#"}, broker.place),
    ):
        settings = ReceiverSettings(name=scheme, options=list_options(broker, **change))
        with pytest.raises(BadInput, match=problem) as refused:
            find_receiver(settings, BrokerAccess(credentials=known))
        assert PASSWORD not in refused.value.message
    settings = ReceiverSettings(name=scheme, options=list_options(broker, credentials=""))
    _, options = find_receiver(settings)
    assert options.credentials == Credentials()


def test_credentials_are_read_by_name(tmp_path: Path):
    file = tmp_path / "credentials.toml"
    assert read_credentials(None) == {}
    with pytest.raises(BadInput, match="cannot be read: No such file"):
        read_credentials(file)
    file.write_text('[range]\nserver = "nats://broker"\nuser = "a"\npassword = "b"\n')
    assert read_credentials(file) == {
        "range": Credentials(server="nats://broker", user="a", password="b")
    }
    for content, problem in (
        ('[range]\nserver = "nats://broker"\nsecret = "b77"\n', "credentials 'range'"),
        ('[range]\nuser = "b77"\n', "with the text server"),
        ("b77 = = \n", "not a TOML file"),
    ):
        file.write_text(content)
        with pytest.raises(BadInput, match=problem) as refused:
            read_credentials(file)
        assert "b77" not in refused.value.message


def test_a_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    options = list_options(NatsServer(tmp_path), credentials="")
    with pytest.raises(BadInput, match=r"pip install 'flexsid\[nats\]'"):
        find_receiver(ReceiverSettings(name="nats", options=options))
