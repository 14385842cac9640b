import json

import pytest
from tests.api import drawn

from treestroke.service import model_request, photos, stored_models
from treestroke.service.engine_version import engine_version
from treestroke.service.jobs import Assignment, grow_model
from treestroke.service.photos import Shelf


@pytest.mark.parametrize("part", ["photo", "strokes"])
def test_a_model_whose_input_is_damaged_fails_and_says_so(shelf: Shelf, part: str) -> None:
    photo = photos.add_photo(shelf, drawn.encoded(seed=3))
    wish = model_request.read_order(json.dumps(drawn.wish(photo.id)).encode())
    model = stored_models.accept_model(shelf, wish, None)
    row, place = model.row, shelf.blobs.path(model.parts[part].blob)
    content = bytearray(place.read_bytes())
    content[-1] ^= 1
    place.write_bytes(content)
    grow_model(shelf.database, shelf.blobs, Assignment(row.id, "token", "worker", 60))
    after = stored_models.find_model(shelf.database, row.id).row
    assert (after.status, after.error and after.error["code"]) == ("failed", "input_damaged")
    assert after.engine == engine_version()
