"""Siblings of a stored model: a new model of the same inputs."""

from treestroke.service.fingerprints import digest
from treestroke.service.model_request import Drawing, ModelOrder
from treestroke.service.photos import Resources
from treestroke.service.quotas import admit_model
from treestroke.service.sibling_request import SiblingsAsked
from treestroke.service.stored_models import (
    StoredModel,
    copy_files,
    find_model,
    finished_model,
    new_row,
    sent_parts,
)
from treestroke.store.tables import ModelPart


def accept_siblings(resources: Resources, id: str, asked: SiblingsAsked) -> StoredModel:
    """Store and queue a model of the same inputs as another one, with siblings.

    Raises
    ------
    NotFound
        There is no such model.
    QuotaExceeded
        As `quotas.admit_model`.
    OSError
        The disk is full.
    """
    model = find_model(resources.database, id)
    old = model.row
    files = {} if asked.envelope is None else {"envelope": asked.envelope}
    settings = {**old.settings, "variants": 1, "siblings": asked.count, "grove": asked.scene}
    seed = old.seed if asked.seed is None else asked.seed
    order = ModelOrder(old.photo, old.capture, old.clip, files, Drawing(None, {}), settings, seed, asked.name, ())
    kept = {
        part.name: ModelPart(name=part.name, blob=part.blob, media_type=part.media_type)
        for part in model.parts.values()
    }
    parts = {**kept, **sent_parts(resources, order)}
    row = new_row(order, None, digest([old.fingerprint, settings, seed, {n: p.blob for n, p in parts.items()}]))
    row.photo = old.photo
    equal = finished_model(resources, row)
    with resources.database.writing() as session:
        admit_model(session, resources.quotas, equal is None)
        session.add(row)
        session.flush()  # parts and files refer to the row
        for part in parts.values():
            part.model = row.id
            session.add(part)
        if equal is not None:
            copy_files(session, equal, row)
    return find_model(resources.database, row.id)
