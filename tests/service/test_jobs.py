import json

import pytest
from tests.api import drawn
from tests.rows import claim

from treestroke.service import model_request, photos, stored_models
from treestroke.service.engine_version import engine_version
from treestroke.service.jobs import grow_model
from treestroke.service.photos import Resources


@pytest.mark.parametrize("part", ["photo", "strokes"])
def test_a_model_whose_input_is_damaged_fails_and_says_so(resources: Resources, part: str) -> None:
    photo = photos.add_photo(resources, drawn.encoded(seed=3))
    order = model_request.read_order(json.dumps(drawn.request(photo.id)).encode())
    model = stored_models.accept_model(resources, order, None)
    row, place = model.row, resources.blobs.path(model.parts[part].blob)
    content = bytearray(place.read_bytes())
    content[-1] ^= 1
    place.write_bytes(content)
    grow_model(resources.database, resources.blobs, claim(resources.database, row), 60)
    after = stored_models.find_model(resources.database, row.id).row
    assert (after.status, after.error and after.error["code"]) == ("failed", "input_damaged")
    assert after.engine == engine_version()
