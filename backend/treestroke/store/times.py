"""Times as they are shown."""

from datetime import UTC, datetime


def iso_time(seconds: float) -> str:
    """Return seconds since 1970 as ISO 8601 in UTC, to a millisecond."""
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
