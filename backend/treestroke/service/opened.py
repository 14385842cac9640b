"""Files that a person names."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from treestroke.core.errors import TreestrokeError


@contextmanager
def open_input(path: str | os.PathLike[str], refusal: type[TreestrokeError]) -> Iterator[BinaryIO]:
    """Open a file that the person named.

    Raises
    ------
    TreestrokeError
        Of the type ``refusal``: the file does not exist or may not be read.
    """
    try:
        with Path(path).open("rb") as file:
            yield file
    except FileNotFoundError as error:
        raise refusal(f"{os.fspath(path)}: there is no such file; check the path") from error
    except (IsADirectoryError, NotADirectoryError, PermissionError) as error:
        raise refusal(f"{os.fspath(path)}: it cannot be read ({error.strerror}); name a file that can") from error
    except ValueError as error:
        raise refusal(f"{os.fspath(path)!r}: this is not a path ({error}); check it") from error
