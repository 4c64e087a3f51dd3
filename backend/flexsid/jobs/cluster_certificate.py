"""Key and certificate of a Dask cluster, as a configuration file of Dask.

Scheduler, workers and servers of one cluster have the same file. Each presents the certificate and
accepts that certificate alone, so that whoever does not have the file can neither connect nor
listen.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path
from textwrap import indent

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from flexsid.errors import BadInput
from flexsid.storage.files import new_file

_VALIDITY = timedelta(days=3 * 365)
_CLOCK_SKEW = timedelta(days=1)  # between the computers of a cluster

# A job that ends its worker does so on the next one, too; the queue has its own attempts.
_CONFIGURATION = """\
# Dask cluster of flexsid. Contains a private key: only its computers may read this file.
distributed:
  comm:
    default-scheme: tls
    require-encryption: true
    tls:
      ca-file: &certificate |
{certificate}
      scheduler: &identity
        cert: *certificate
        key: |
{key}
      worker: *identity
      client: *identity
  scheduler:
    allowed-failures: 0
"""


def write_cluster_certificate(file: Path, now: datetime) -> datetime:
    """Write a configuration file with a new key and certificate, and return the end of validity.

    Parameters
    ----------
    file
        A new file, to be named by ``DASK_CONFIG``; readable by its account only.
    now
        Present time, with time zone.

    Raises
    ------
    BadInput
        If the file exists or cannot be written.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "flexsid cluster")])
    end = now + _VALIDITY
    certificate = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - _CLOCK_SKEW)
        .not_valid_after(end)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .sign(key, hashes.SHA256())
    )
    private = key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    text = _CONFIGURATION.format(
        certificate=_indent(certificate.public_bytes(serialization.Encoding.PEM), 8),
        key=_indent(private, 10),
    )
    try:
        with new_file(file) as partial:
            partial.write_text(text)
    except FileExistsError as error:
        raise BadInput(
            f"{file} exists; a cluster that uses it would not accept a new certificate"
        ) from error
    except OSError as error:
        raise BadInput(f"{file} cannot be written: {error.strerror}") from error
    return end


def find_end_of_validity(certificate: str) -> datetime | None:
    """Return the end of validity of a certificate in PEM form, or of a file with one.

    None where it cannot be read; Dask states the reason when it connects.
    """
    try:
        is_text = certificate.lstrip().startswith("-----BEGIN")
        pem = certificate.encode() if is_text else Path(certificate).read_bytes()
        return x509.load_pem_x509_certificate(pem).not_valid_after_utc
    except (OSError, ValueError):
        return None


def _indent(pem: bytes, width: int) -> str:
    return indent(pem.decode().strip(), " " * width)
