"""Where a test lets a job go on that is named "held"."""

from pathlib import Path


def released(folder: Path, model: str) -> Path:
    """Return the file that the job waits for, beside the service's data folder."""
    return folder.with_name(f"{folder.name}.{model}.released")
