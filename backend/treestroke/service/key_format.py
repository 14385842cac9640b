"""How a key is written: ``ts_``, 37 random characters, and a checksum, so that a mistyped one is told at once."""

import hmac
import re
import secrets
import string
import zlib

_ALPHABET = string.digits + string.ascii_uppercase + string.ascii_lowercase
_RANDOM, _CHECKSUM, _SHOWN = 37, 6, 7
_PATTERN = re.compile(rf"ts_([0-9A-Za-z]{{{_RANDOM}}})([0-9A-Za-z]{{{_CHECKSUM}}})")


def new_key() -> str:
    """Return a new key: 220 random bits, so that none is guessed."""
    body = "".join(secrets.choice(_ALPHABET) for _ in range(_RANDOM))
    return f"ts_{body}{_checksum(body)}"


def is_key(text: str) -> bool:
    """Tell whether a text can be a key: it is written as one, and its checksum is right."""
    found = _PATTERN.fullmatch(text)
    return found is not None and _checksum(found[1]) == found[2]


def beginning_of(key: str) -> str:
    """Return the characters by which its owner knows a key, and nobody can use it."""
    return key[:_SHOWN]


def digest_of(secret: str, token: str) -> str:
    """Return what is stored of a key, or of a session's token: its HMAC-SHA-256 by the service's secret."""
    return hmac.digest(secret.encode(), token.encode(), "sha256").hex()


def _checksum(body: str) -> str:
    """Return the CRC-32 of a key's random characters, written in the same alphabet."""
    left, written = zlib.crc32(body.encode()), ""
    for _ in range(_CHECKSUM):
        left, digit = divmod(left, len(_ALPHABET))
        written = _ALPHABET[digit] + written
    return written
