"""Recordings of whole flights in chunks, and the channels of a maneuver with their samples.

A chunk has consecutive samples of one channel and is named by the SHA-256 of its bytes. The names
of all chunks of a channel are an array of the database. Its name, the hash of these hashes, thus
stands for every sample, and backups, seals and checks of the database hold for chunks, too. A
window of a long recording is read from the few chunks that it touches.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib import import_module
from operator import itemgetter
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Channel, FlightChannel, Role
from flexsid.storage.arrays import HASH_BYTES, DamagedData, build_damage_error, is_intact
from flexsid.storage.database import Database
from flexsid.storage.files import DatabaseUnavailable, new_file
from flexsid.storage.tables import arrays, channels, flight_channels
from flexsid.sysid.preparation.resampling import BetweenSamples

# --- Channels of a maneuver or a whole flight together with their samples, in one statement -------

_Kind = TypeVar("_Kind", Channel, FlightChannel)
_ROLES = {role.value: role for role in Role}


def read_channels(
    database: Database, maneuver_id: int, names: Sequence[str] | None = None
) -> dict[str, tuple[Channel, np.ndarray]]:
    """Read channels of a maneuver with their samples, by name, in the order of the record.

    Parameters
    ----------
    database
        The database.
    maneuver_id
        Id of the maneuver.
    names
        Names of channels, all with None; names that are not recorded are omitted.

    Returns
    -------
    dict
        Channels with samples in native unit and precision, read-only.

    Raises
    ------
    DamagedData
        If samples are not what was stored.
    """
    return _read(database, Channel, channels.name, "maneuver_id", maneuver_id, names)


def read_flight_channels(
    database: Database, flight_id: int, names: Sequence[str] | None = None
) -> dict[str, tuple[FlightChannel, np.ndarray]]:
    """Read channels of a whole flight; see ``read_channels``.

    The array of a channel in chunks has the names of its chunks, (n_chunks, 32) bytes.
    """
    return _read(database, FlightChannel, flight_channels.name, "flight_id", flight_id, names)


def _read(
    database: Database,
    kind: type[_Kind],
    table: str,
    key: str,
    identity: int,
    names: Sequence[str] | None,
) -> dict[str, tuple[_Kind, np.ndarray]]:
    requested = None if names is None else tuple(dict.fromkeys(names))
    if requested == ():
        return {}
    fields = tuple(kind.__dataclass_fields__)
    with database.reading() as connection:
        mark = "?" if connection.dialect.paramstyle == "qmark" else "%s"
        query = _query(table, key, fields, mark, None if requested is None else len(requested))
        cursor = connection.connection.cursor()
        try:
            cursor.execute(query, (identity, *(requested or ())))
            rows = cursor.fetchall()
        except connection.dialect.loaded_dbapi.Error as error:
            raise DatabaseUnavailable(f"the database does not respond: {error}") from error
        finally:
            cursor.close()
    # Sorted here: the database would sort the samples with their rows.
    rows = sorted(rows, key=itemgetter(fields.index("id")))
    found: dict[str, tuple[_Kind, np.ndarray]] = {}
    for row in rows:
        # pyrefly: ignore[bad-argument-type]
        channel, (checksum, unit, dtype, data) = _record(kind, fields, row), row[-4:]
        shape = _find_shape(channel)
        if not is_intact(channel.array, checksum, dtype, shape, unit, data):
            with database.reading() as connection:
                raise build_damage_error(connection, channel.array)
        found[channel.name] = channel, np.frombuffer(data, dtype).reshape(shape)
    return found


def _find_shape(channel: Channel | FlightChannel) -> tuple[int, ...]:
    if isinstance(channel, FlightChannel) and channel.samples_per_chunk is not None:
        return -(-channel.n_samples // channel.samples_per_chunk), HASH_BYTES
    return (channel.n_samples,)


@lru_cache(maxsize=256)
def _query(table: str, key: str, fields: tuple[str, ...], mark: str, n_names: int | None) -> str:
    """Return plain SQL for the driver: SQLAlchemy would double the time of the query."""
    # Quoted: ``array`` is a reserved word of PostgreSQL.
    columns = ", ".join(f'{table}."{name}"' for name in fields)
    selection = "" if n_names is None else f" AND name IN ({', '.join([mark] * n_names)})"
    return (
        f"SELECT {columns}, checksum, arrays.unit, dtype, data FROM {table} "
        f'JOIN {arrays.name} ON hash = "array" WHERE {key} = {mark}{selection}'
    )


def _record(kind: type[_Kind], fields: tuple[str, ...], row: Sequence[Any]) -> _Kind:
    values = dict(zip(fields, row, strict=False))
    values["role"] = _ROLES[values["role"]]
    if (between := values["between_samples"]) is not None:
        values["between_samples"] = BetweenSamples(between)
    return kind(**values)


# --- Recordings of whole flights in chunks: Parquet files on any file system that fsspec reaches

SAMPLES_PER_CHUNK = 2**18
"""Samples of a chunk: 2 MB of float64, 22 minutes at 200 Hz."""

_EVERYTHING = (-np.inf, np.inf)
_AT_ONCE = 8  # chunks; a file system of another computer takes most of the time to respond


@dataclass(frozen=True, slots=True)
class Chunks:
    """Names of the chunks of a channel, (n_chunks, 32) bytes, of ``length`` samples each."""

    names: np.ndarray
    length: int


class Recordings:
    """Store of chunks at an address such as ``file:///srv/recordings`` or ``s3://bucket/folder``.

    Raises
    ------
    BadInput
        If the address has no known form, or what reads it is not installed.
    """

    def __init__(self, url: str, samples_per_chunk: int = SAMPLES_PER_CHUNK) -> None:
        self.samples_per_chunk = samples_per_chunk
        try:
            import_module("pyarrow.parquet")  # missing packages are found before the first read
            from fsspec.core import url_to_fs
            from fsspec.implementations.local import LocalFileSystem

            self._files, root = url_to_fs(url)
        except ImportError as error:
            raise BadInput(
                f"the file system of FLEXSID_RECORDINGS cannot be used ({error}); install"
                " 'flexsid[recordings]' and the package of this file system"
            ) from error
        except ValueError as error:
            raise BadInput(
                f"FLEXSID_RECORDINGS is no address of a file system ({error}); expected one like"
                " file:///srv/recordings or s3://bucket/folder"
            ) from error
        self._root = root.rstrip("/")
        self._is_local = isinstance(self._files, LocalFileSystem)

    def write(self, name: str, samples: np.ndarray, unit: str) -> Chunks:
        """Write the samples of a channel; chunks that exist are not written again.

        Raises
        ------
        DatabaseUnavailable
            If a chunk cannot be written.
        """

        def write_chunk(first: int) -> np.ndarray:
            content = _encode(name, samples[first : first + self.samples_per_chunk], unit)
            digest = hashlib.sha256(content).digest()
            self._put(digest.hex(), content)
            return np.frombuffer(digest, np.uint8)

        with ThreadPoolExecutor(_AT_ONCE) as writers:
            names = writers.map(write_chunk, range(0, samples.size, self.samples_per_chunk))
            return Chunks(np.stack(list(names)), self.samples_per_chunk)

    def read(self, chunks: Chunks, window: slice) -> np.ndarray:
        """Read a window of the samples of a channel from the chunks that it touches.

        Raises
        ------
        DatabaseUnavailable
            If a chunk cannot be read.
        DamagedData
            If a chunk is not what was written.
        """
        # An empty window, too, has the type of the samples of a chunk.
        first = min(window.start // chunks.length, len(chunks.names) - 1)
        last = max(-(-window.stop // chunks.length), first + 1)
        pieces = []
        for index in range(first, last):
            samples = self._read_chunk(chunks.names[index].tobytes().hex())
            begin = index * chunks.length
            low, high = max(window.start - begin, 0), max(window.stop - begin, 0)
            pieces.append(samples[low:high])
        return np.concatenate(pieces)  # of copies, which do not retain their chunks

    def find_damaged(self, names: np.ndarray) -> Iterator[str]:
        """Describe the chunks that are missing or damaged."""
        for name in names:
            try:
                self._read_chunk(name.tobytes().hex())
            except (DatabaseUnavailable, DamagedData) as error:
                yield error.message

    def _read_chunk(self, name: str) -> np.ndarray:
        import pyarrow.parquet as pq

        path = self._locate(name)
        try:
            content = self._files.cat_file(path)
        except Exception as error:  # each file system has its own
            raise DatabaseUnavailable(
                f"the chunk {path} of a recording cannot be read: {error or type(error).__name__}",
                code="recording-unavailable",
            ) from error
        if hashlib.sha256(content).hexdigest() != name:
            raise DamagedData(
                f"the chunk {path} of a recording is damaged: its content does not match its name;"
                " copy it from a backup of the recordings, or import the file of the flight again"
            )
        column = pq.read_table(io.BytesIO(content), use_threads=False).column(0)
        return column.to_numpy()

    def _put(self, name: str, content: bytes) -> None:
        path = self._locate(name)
        try:
            if self._is_local:
                self._put_local(Path(path), content)
            elif not self._files.exists(path) or self._files.cat_file(path) != content:
                self._files.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
                self._files.pipe_file(path, content)
        except Exception as error:  # each file system has its own
            raise DatabaseUnavailable(
                f"the chunk {path} of a recording cannot be written: {error}",
                code="recording-unavailable",
            ) from error

    def _put_local(self, file: Path, content: bytes) -> None:
        """Write a file that is complete and on disk, or not there."""
        if file.exists():
            if file.read_bytes() == content:
                return
            file.unlink()  # damaged
        file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        # Another process may write the same chunk at the same time.
        with suppress(FileExistsError), new_file(file) as partial:
            partial.write_bytes(content)

    def _locate(self, name: str) -> str:
        return f"{self._root}/{name[:2]}/{name}.parquet"


def read_recording(
    database: Database,
    recordings: Recordings | None,
    flight_id: int,
    names: Sequence[str] | None = None,
    interval_s: tuple[float, float] = _EVERYTHING,
) -> dict[str, tuple[FlightChannel, np.ndarray]]:
    """Read channels of a whole flight within an interval.

    Parameters
    ----------
    database
        The database.
    recordings
        Store of the chunks of long recordings, if there is one.
    flight_id
        Id of the flight.
    names
        Names of channels, all with None; names that are not recorded are omitted.
    interval_s
        First and last time on the clock of the recorder. [s]

    Returns
    -------
    dict
        Channels by name with the start and number of the samples within the interval, and these
        samples in native unit and precision.

    Raises
    ------
    DatabaseUnavailable
        If the chunks of a channel cannot be read.
    DamagedData
        If samples do not match their hash.
    """

    def read(channel: FlightChannel, stored: np.ndarray) -> tuple[FlightChannel, np.ndarray]:
        window = channel.slice_samples(interval_s)
        length = channel.samples_per_chunk
        if length is None:
            samples = stored[window]
        elif recordings is None:
            raise DatabaseUnavailable(
                f"the samples of channel '{channel.name}' are in chunks outside the database; set"
                " FLEXSID_RECORDINGS to their address",
                code="recording-unavailable",
            )
        else:
            samples = recordings.read(Chunks(stored, length), window)
        start_s, count = channel.get_time(window.start), window.stop - window.start
        return replace(channel, start_s=start_s, n_samples=count), samples

    stored = read_flight_channels(database, flight_id, names)
    with ThreadPoolExecutor(_AT_ONCE) as readers:
        found = readers.map(read, *zip(*stored.values(), strict=True)) if stored else ()
        return dict(zip(stored, found, strict=True))


def _encode(name: str, samples: np.ndarray, unit: str) -> bytes:
    """Encode samples as a Parquet file that other programs read."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    field = pa.field(name, pa.from_numpy_dtype(samples.dtype), False, {"unit": unit})
    table = pa.table([pa.array(samples)], schema=pa.schema([field]))
    encoded = io.BytesIO()
    # Bytes of equal significance side by side compress well; dictionaries do not.
    split: Any = samples.dtype.kind == "f"
    pq.write_table(
        *(table, encoded),
        compression="zstd",
        use_dictionary=False,
        use_byte_stream_split=split,
        write_statistics=False,
    )
    return encoded.getvalue()
