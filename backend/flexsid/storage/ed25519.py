"""Signatures Ed25519 after RFC 8032, from the hash function of the standard library.

Signing is not in constant time: the key must not be used where an attacker measures durations
of single signatures on the same computer.
"""

from __future__ import annotations

import hashlib
from typing import Final

_P: Final = 2**255 - 19  # field
_ORDER: Final = 2**252 + 27742317777372353535851937790883648493  # of the base point
_D: Final = -121665 * pow(121666, -1, _P) % _P
_ROOT_OF_MINUS_ONE: Final = pow(2, (_P - 1) // 4, _P)
_LENGTH: Final = 32  # bytes of a key, of a coordinate and of a scalar

_Point = tuple[int, int, int, int]  # extended coordinates X, Y, Z, T = X Y / Z
_NEUTRAL: Final[_Point] = (0, 1, 1, 0)


def derive_public_key(secret: bytes) -> bytes:
    """Derive the public key (32 bytes) of a secret of 32 random bytes."""
    return _compress(_multiply(_expand(secret)[0], _BASE))


def sign(secret: bytes, message: bytes) -> bytes:
    """Sign a message; the signature has 64 bytes.

    Notes
    -----
    Source: RFC 8032, sec. 5.1.6.
    """
    scalar, prefix = _expand(secret)
    public = _compress(_multiply(scalar, _BASE))
    nonce = _hash_to_scalar(prefix, message)
    commitment = _compress(_multiply(nonce, _BASE))
    response = (nonce + _hash_to_scalar(commitment, public, message) * scalar) % _ORDER
    return commitment + response.to_bytes(_LENGTH, "little")


def is_valid(public: bytes, message: bytes, signature: bytes) -> bool:
    """Whether a signature of a message was made with the secret of a public key.

    Notes
    -----
    Source: RFC 8032, sec. 5.1.7; points and scalars that are not canonical are refused.
    """
    if len(public) != _LENGTH or len(signature) != 2 * _LENGTH:
        return False
    key, commitment = _decompress(public), _decompress(signature[:_LENGTH])
    response = int.from_bytes(signature[_LENGTH:], "little")
    if key is None or commitment is None or response >= _ORDER:
        return False
    challenge = _hash_to_scalar(signature[:_LENGTH], public, message)
    return _is_same(_multiply(response, _BASE), _add(commitment, _multiply(challenge, key)))


def _expand(secret: bytes) -> tuple[int, bytes]:
    digest = hashlib.sha512(secret).digest()
    scalar = int.from_bytes(digest[:_LENGTH], "little")
    return (scalar & ((1 << 254) - 8)) | (1 << 254), digest[_LENGTH:]


def _hash_to_scalar(*parts: bytes) -> int:
    return int.from_bytes(hashlib.sha512(b"".join(parts)).digest(), "little") % _ORDER


def _add(p: _Point, q: _Point) -> _Point:
    a, b = (p[1] - p[0]) * (q[1] - q[0]) % _P, (p[1] + p[0]) * (q[1] + q[0]) % _P
    c, d = 2 * p[3] * q[3] * _D % _P, 2 * p[2] * q[2] % _P
    e, f, g, h = b - a, d - c, d + c, b + a
    return e * f % _P, g * h % _P, f * g % _P, e * h % _P


def _multiply(scalar: int, point: _Point) -> _Point:
    product = _NEUTRAL
    while scalar:
        if scalar & 1:
            product = _add(product, point)
        point = _add(point, point)
        scalar >>= 1
    return product


def _is_same(p: _Point, q: _Point) -> bool:
    return (p[0] * q[2] - q[0] * p[2]) % _P == 0 and (p[1] * q[2] - q[1] * p[2]) % _P == 0


def _compress(point: _Point) -> bytes:
    inverse = pow(point[2], -1, _P)
    x, y = point[0] * inverse % _P, point[1] * inverse % _P
    return (y | ((x & 1) << 255)).to_bytes(_LENGTH, "little")


def _decompress(text: bytes) -> _Point | None:
    y = int.from_bytes(text, "little")
    odd, y = y >> 255, y & ((1 << 255) - 1)
    x = None if y >= _P else _recover_x(y, odd)
    return None if x is None else (x, y, 1, x * y % _P)


def _recover_x(y: int, odd: int) -> int | None:
    square = (y * y - 1) * pow(_D * y * y + 1, -1, _P) % _P
    if square == 0:
        return None if odd else 0
    x = pow(square, (_P + 3) // 8, _P)
    if (x * x - square) % _P != 0:
        x = x * _ROOT_OF_MINUS_ONE % _P
    if (x * x - square) % _P != 0:
        return None
    return _P - x if (x & 1) != odd else x


def _build_base() -> _Point:
    y = 4 * pow(5, -1, _P) % _P
    x = _recover_x(y, 0)
    assert x is not None
    return x, y, 1, x * y % _P


_BASE: Final = _build_base()
