"""Streams of samples by scripts: started, read and stopped while an aircraft flies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flexsid.client.connection import Requests, table

if TYPE_CHECKING:
    import pandas


class Live:
    """Streams of a workbench: ``workbench.live``."""

    def __init__(self, workbench: Requests) -> None:
        self._workbench = workbench

    def receivers(self) -> list[dict[str, Any]]:
        """Return the ways to receive samples, with their options."""
        return self._workbench.get("live/receivers")["items"]

    def streams(self) -> pandas.DataFrame:
        """Return all streams, newest first."""
        return table(self._workbench.get("live/streams")["items"])

    def start(
        self,
        run_id: int,
        title: str,
        receiver: str,
        options: dict[str, Any] | None = None,
        **settings: Any,
    ) -> int:
        """Start a stream; return its id.

        Parameters
        ----------
        run_id
            Run whose model, channels and settings the stream has.
        title
            Title on the page.
        receiver
            Name, such as ``nats``.
        options
            Of the receiver.
        **settings
            ``flight_id`` in which maneuvers are stored, ``next_airspeed_m_s`` of the next test
            point, ``limits`` of channels as (lowest, highest).

        Raises
        ------
        RequestRefused
            Naming the option that is missing or invalid.
        """
        source = {"name": receiver, "options": options or {}}
        body = {"run_id": run_id, "title": title, "receiver": source, **settings}
        return self._workbench.post("live/streams", body)["id"]

    def stream(self, stream_id: int) -> dict[str, Any]:
        """Return a stream: channels, present state, test points and alarms."""
        return self._workbench.get(f"live/streams/{stream_id}")

    def history(self, stream_id: int, **query: Any) -> list[dict[str, Any]]:
        """Return what was known at each second, oldest first; ``since_s`` and ``limit``."""
        return self._workbench.get(f"live/streams/{stream_id}/history", **query)["states"]

    def push(self, stream_id: int, packets: bytes) -> int:
        """Pass packets to a stream with the receiver ``push``; return the number of frames."""
        return self._workbench.send_bytes(f"live/streams/{stream_id}/frames", packets)["frames"]

    def stop(self, stream_id: int) -> dict[str, Any]:
        """Stop a stream; a maneuver that is being flown is stored as far as it was received."""
        return self._workbench.post(f"live/streams/{stream_id}/stop", {})
