"""How long each stage takes on two bundled photos of 1200 px, one thread, settings as they come."""

from dataclasses import dataclass, replace
from functools import cache
from itertools import count

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture
from tests.conftest import EXAMPLES

import treestroke
from treestroke.codec.gltf.tree import Part, encode_glb
from treestroke.codec.image import decode_photo
from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.replacement import CrownToFill, Replacement, grow
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.leaf_crown import leaf_crown
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.lift.spread import FrontCrown, FrontTree, lift
from treestroke.core.mesh.bark import BarkParams, bark_texture
from treestroke.core.mesh.tubes import tubes
from treestroke.core.paint.atlas import leaf_atlas
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.levels import levels
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Strokes
from treestroke.core.sway.skinning import skin
from treestroke.core.sway.wind import wind_of
from treestroke.service.loading import load_strokes
from treestroke.service.model import Model
from treestroke.service.trace import Trace

pytestmark = pytest.mark.parametrize("subject", ["burr_oak_dusk", "oak_02"], indirect=True)


@dataclass(frozen=True, eq=False)
class Subject:
    """What the stages of one example take in; the photo is small enough to be worked on at its own size."""

    encoded: bytes
    strokes: Strokes
    trace: Trace
    skeleton: Skeleton
    model: Model
    crown: CrownToFill

    @property
    def photo(self) -> NDArray[np.uint8]:
        return self.trace.photo

    @property
    def tree(self) -> TreeModel:
        return self.model.tree


@cache
def _subject(name: str) -> Subject:
    encoded, strokes = (EXAMPLES / f"{name}.jpg").read_bytes(), load_strokes(EXAMPLES / f"{name}.strokes.json")
    trace, model = treestroke.trace(encoded, strokes), treestroke.model(encoded, strokes)
    assert trace.skeleton is not None
    front = Silhouette(trace.foliage, model.tree.camera)
    crown = CrownToFill(turned_outline(front), front)
    return Subject(encoded, strokes, trace, trace.skeleton, model, crown)


@pytest.fixture
def subject(request: pytest.FixtureRequest) -> Subject:
    return _subject(request.param)


def _lifted(subject: Subject) -> Skeleton:
    crown = FrontCrown(subject.crown.volume, subject.crown.front.camera)
    tree = FrontTree(subject.skeleton, subject.trace.stroke, subject.trace.stroke < 0)
    return lift(tree, crown, np.random.default_rng(0))


def test_decoding(benchmark: BenchmarkFixture, subject: Subject) -> None:
    photo = benchmark.pedantic(decode_photo, (subject.encoded, "photo"), rounds=5)
    assert np.array_equal(photo, subject.photo)


def test_finding_the_foliage_of_a_new_crown(benchmark: BenchmarkFixture, subject: Subject) -> None:
    crown_alone = replace(subject.strokes, branches=())
    found = benchmark.pedantic(treestroke.trace, (subject.photo, crown_alone), rounds=3)
    assert np.array_equal(found.foliage, subject.trace.foliage)


def test_tracing_one_more_branch_stroke(benchmark: BenchmarkFixture, subject: Subject) -> None:
    before = treestroke.trace(subject.photo, replace(subject.strokes, branches=subject.strokes.branches[:-1]))
    arguments = {"photo": subject.photo, "strokes": subject.strokes, "after": before}
    found = benchmark.pedantic(treestroke.trace, kwargs=arguments, rounds=5)
    assert np.array_equal(found.skeleton.points, subject.skeleton.points)


def test_lifting(benchmark: BenchmarkFixture, subject: Subject) -> None:
    assert len(benchmark.pedantic(_lifted, (subject,), rounds=5)) == len(subject.skeleton)


def test_growing(benchmark: BenchmarkFixture, subject: Subject) -> None:
    lifted, kind = _lifted(subject), subject.tree.taken.foliage
    method = Replacement(choose_library("auto", kind, lifted), growth_for(kind))

    def run() -> int:
        return len(grow(lifted, subject.crown, method, np.random.default_rng(0)).choices)

    assert benchmark.pedantic(run, rounds=5) > 200


def test_drawing_the_leaf_atlas_and_hanging_the_leaves(benchmark: BenchmarkFixture, subject: Subject) -> None:
    photo, mask, kind = subject.photo, subject.trace.foliage, subject.tree.taken.foliage
    leaves_from = np.where(mask, -np.inf, np.inf).astype(np.float32)
    stem = StemPixels(np.zeros((2, 2)), np.zeros(2))
    view = View(subject.crown.front.camera, photo, leaves_from, mask.astype(np.float32), mask, mask, stem)

    def run() -> int:
        rng = np.random.default_rng(0)
        atlas = leaf_atlas(photo, mask, kind, rng)
        skeleton = subject.tree.grown.skeleton
        crown = leaf_crown(Appearance((view,), True), subject.crown.volume, atlas, 1.0, rng)
        leaves = place_leaves(skeleton, crown, LeafParams(kind=kind), rng)
        return len(Surface(cards(leaves, atlas), atlas.image).mesh.triangles)

    assert benchmark.pedantic(run, rounds=3) > 10_000


def test_wrapping_the_branches_in_tubes(benchmark: BenchmarkFixture, subject: Subject) -> None:
    mesh = benchmark.pedantic(tubes, (subject.tree.grown.skeleton,), rounds=5)
    assert np.array_equal(mesh.positions, subject.tree.bark.mesh.positions)


def test_making_the_bark_texture(benchmark: BenchmarkFixture, subject: Subject) -> None:
    trunk = subject.trace.stroke == 0
    axis, radii = subject.skeleton.points[trunk], subject.skeleton.radii[trunk]
    arguments = subject.photo, StemPixels(axis, radii), BarkParams(), np.random.default_rng(0)
    assert benchmark.pedantic(bark_texture, arguments, rounds=5).shape == (512, 256, 3)


def test_encoding_the_glb(benchmark: BenchmarkFixture, subject: Subject) -> None:
    parts = [Part("bark", subject.tree.bark), Part("leaf", subject.tree.leaf)]
    arguments = parts, subject.tree.camera
    generator = {"generator": "treestroke"}
    assert benchmark.pedantic(encode_glb, arguments, generator, rounds=5)[:4] == b"glTF"


def test_encoding_the_compressed_glb(benchmark: BenchmarkFixture, subject: Subject) -> None:
    parts = [Part("bark", subject.tree.bark), Part("leaf", subject.tree.leaf)]
    how = {"generator": "treestroke", "compress": True}
    assert len(benchmark.pedantic(encode_glb, (parts, subject.tree.camera), how, rounds=3)) < 2_500_000


def test_letting_the_wind_move_it(benchmark: BenchmarkFixture, subject: Subject) -> None:
    tree = subject.tree

    def run() -> int:
        wind = wind_of(tree.grown.skeleton, ("breeze", "gust"), tree.cards.joints)
        return len(skin(wind.rig, tree.bark.mesh, leaves=False).bones) + len(
            skin(wind.rig, tree.leaf.mesh, leaves=True).bones
        )

    assert benchmark.pedantic(run, rounds=3) == len(tree.bark.mesh.positions) + len(tree.leaf.mesh.positions)


def test_making_the_levels_of_detail(benchmark: BenchmarkFixture, subject: Subject) -> None:
    made = benchmark.pedantic(levels, (subject.tree,), rounds=2)
    whole, coarse = ((subject.tree.bark, subject.tree.leaf), made.lod2.surfaces)
    counts = [sum(len(surface.mesh.triangles) for surface in surfaces) for surfaces in (whole, coarse)]
    assert counts[1] < 0.1 * counts[0]


def test_drawing_the_preview(benchmark: BenchmarkFixture, subject: Subject) -> None:
    assert benchmark.pedantic(subject.model.preview, rounds=2).dtype == np.uint8


def test_the_whole_model(benchmark: BenchmarkFixture, subject: Subject) -> None:
    seeds = count(1)
    model = benchmark.pedantic(lambda: treestroke.model(subject.encoded, subject.strokes, seed=next(seeds)), rounds=2)
    assert model.report["counts"]["leaves"] > 5000
