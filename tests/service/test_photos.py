import hashlib

import pytest
from tests.api import drawn

from treestroke.core.errors import PhotoError
from treestroke.service import photos
from treestroke.service.photos import NotFound, Shelf
from treestroke.store.tables import Photo


def count(shelf: Shelf, table: type[Photo]) -> int:
    with shelf.database.reading() as session:
        return session.query(table).count()


def test_a_photo_is_kept_once_it_is_decoded(shelf: Shelf) -> None:
    row = photos.add_photo(shelf, drawn.encoded("JPEG"))
    assert photos.get_photo(shelf, row.id).blob == row.blob
    assert shelf.blobs.get(row.blob).startswith(b"\x89PNG")


def test_a_photo_that_cannot_be_used_leaves_nothing(shelf: Shelf) -> None:
    with pytest.raises(PhotoError):
        photos.add_photo(shelf, b"no photo")
    assert count(shelf, Photo) == 0
    assert not shelf.blobs.folder.exists()


def test_the_same_photo_twice_is_two_photos_and_one_file(shelf: Shelf) -> None:
    first, second = (photos.add_photo(shelf, drawn.encoded()) for _ in range(2))
    assert first.id != second.id
    assert first.blob == second.blob
    assert first.sha256 == second.sha256 == hashlib.sha256(drawn.encoded()).hexdigest()
    photos.delete_photo(shelf, first.id)
    assert photos.get_photo(shelf, second.id)
    with pytest.raises(NotFound):
        photos.delete_photo(shelf, first.id)
    with pytest.raises(NotFound):
        photos.trace_photo(shelf, first.id, b"{}")
