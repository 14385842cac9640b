"""A store that is swept, and the clocks that it goes by."""

import threading
import time
from dataclasses import fields
from pathlib import Path

import pytest
from sqlalchemy import func, select
from tests.rows import add_model

from treestroke.service import retention, stored_models
from treestroke.service.retention import Sweeper, Swept
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.queries import referenced
from treestroke.store.scope import LOCAL, SERVICE
from treestroke.store.tables import (
    ClipRow,
    File,
    ModelRow,
    PhotoRow,
    Table,
    UploadRow,
)
from treestroke.store.upload_pieces import open_uploads

HOUR, DAY = 3600.0, 86_400.0
NOTHING = Swept(0, 0, 0, 0, 0, 0)


class Clocks:
    """The clock on the wall, and that of the process, which alone never jumps."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.wall, self.running = time.time(), 0.0
        monkeypatch.setattr(retention.time, "time", lambda: self.wall)

    def pass_(self, seconds: float) -> None:
        self.wall += seconds
        self.running += seconds


class Kept:
    """A store whose process sweeps it now and then."""

    def __init__(self, folder: Path, clocks: Clocks, bucket_url: str = "") -> None:
        self.database, self.clocks = Database(folder).of(LOCAL), clocks
        self.database.migrate()
        self.blobs = open_blobs(self.database, folder, bucket_url).of(LOCAL)
        self.uploads = open_uploads(self.database, self.blobs).of(LOCAL)
        self.restart()

    def restart(self, keep_days: float = 0) -> None:
        clocks = self.clocks
        service, over = self.database.of(SERVICE), threading.Event()
        self._sweeper = Sweeper(service, self.blobs.of(SERVICE), keep_days, over, lambda: clocks.running)

    def sweep(self) -> Swept:
        return self._sweeper.sweep()

    def sweep_for(self, seconds: float) -> Swept:
        """Let time pass, with a sweep every hour; give what went in all."""
        went = [self.sweep()]
        for _ in range(round(seconds / HOUR)):
            self.clocks.pass_(HOUR)
            went.append(self.sweep())
        return Swept(*(sum(getattr(one, field.name) for one in went) for field in fields(Swept)))

    def photo(self, id: str) -> PhotoRow:
        row = PhotoRow(id=id, sha256="", width=1, height=1, blob=self.blobs.put(id.encode()), created=self.clocks.wall)
        with self.database.writing() as session:
            session.add(row)
        return row

    def clip(self, id: str) -> ClipRow:
        told = {"name": "", "frames": 60, "frames_per_second": 30.0, "media_type": "video/mp4"}
        blob = self.blobs.put(id.encode())
        row = ClipRow(id=id, sha256="", width=1, height=1, blob=blob, created=self.clocks.wall, **told)
        with self.database.writing() as session:
            session.add(row)
        return row

    def upload(self, id: str) -> None:
        with self.database.writing() as session:
            session.add(UploadRow(id=id, name="", created=self.clocks.wall))
        with self.uploads.adding(id, 0) as writer:
            writer.write(b"video")

    def model(self, status: str = "succeeded", **parts: str) -> ModelRow:
        blobs = {"photo": self.blobs.put(b"photo"), "strokes": self.blobs.put(b"strokes"), **parts}
        row = add_model(self.database, blobs, status=status, created=self.clocks.wall)
        tree = self.blobs.put(b"tree of " + row.id.encode())
        with self.database.writing() as session:
            session.add(File(model=row.id, name="tree.glb", blob=tree, bytes=4))
        return row

    def delete(self, row: ModelRow) -> None:
        stored_models.delete(self.database, row.id)

    def count(self, table: type[Table]) -> int:
        with self.database.reading() as session:
            return session.scalar(select(func.count()).select_from(table)) or 0

    def files(self) -> set[str]:
        return {name for _, sizes in self.blobs.objects.pages() for name in sizes}

    def named(self) -> set[str]:
        with self.database.reading() as session:
            return referenced(session)
