"""What a tree is taken for: the kind of its foliage and its form, and how sure that is."""

from dataclasses import dataclass

from treestroke.core.paint.seasons import LEAFY
from treestroke.core.paint.species import AUTO, SPECIES
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.segment.kind import KindOdds, likeliest
from treestroke.core.types import FOLIAGE_KINDS, TREE_FORMS, FoliageKind, TreeForm

ASK_BELOW = 0.7
"""Sureness below which a person should be asked what the twigs bear: that of 22 % of the pictures whose trees were left
out of the fit, and of 68 % of those among them that were taken wrongly."""
_KINDS: dict[str, FoliageKind] = {kind: kind for kind in FOLIAGE_KINDS}
_FORMS: dict[str, TreeForm] = {form: form for form in TREE_FORMS}


@dataclass(frozen=True)
class Taken:
    """What a tree is taken for.

    Attributes
    ----------
    foliage
        What its twigs bear.
    form
        How its limbs grow.
    sureness
        Probability, 0 to 1, that the foliage is right; 1 where the settings say it.
    """

    foliage: FoliageKind
    form: TreeForm
    sureness: float

    @property
    def ask(self) -> bool:
        """Whether a person should be asked what the twigs bear."""
        return self.sureness < ASK_BELOW


def taken_for(odds: KindOdds, form: TreeForm, settings: ModelSettings) -> Taken:
    """Return what a tree is taken for: by the settings, else by season, species and picture, in this order.

    ``odds`` and ``form`` are what the picture shows.
    """
    foliage, sureness = _foliage(odds, settings)
    return Taken(foliage, form if settings.form == "auto" else _FORMS[settings.form], sureness)


def shown_kind(odds: KindOdds, settings: ModelSettings) -> FoliageKind:
    """Return the kind of foliage that the picture shows: by the settings, unless their season is another one."""
    if settings.foliage == "auto" or settings.season in LEAFY:
        return likeliest(odds)
    return _KINDS[settings.foliage]


def _foliage(odds: KindOdds, settings: ModelSettings) -> tuple[FoliageKind, float]:
    """Return what the twigs bear, and how sure that is."""
    if settings.season == "bare":
        return "bare", 1.0
    if settings.foliage != "auto":
        return _KINDS[settings.foliage], 1.0
    species, shown = SPECIES.get(settings.species, AUTO), likeliest(odds)
    leafy = settings.season in LEAFY or species.evergreen
    if species != AUTO:
        own: FoliageKind = "leaves" if species.needles is None else "needles"
        return (own, 1.0) if leafy else ("bare", odds["bare"]) if shown == "bare" else (own, 1.0 - odds["bare"])
    return ("leaves" if leafy and shown == "bare" else shown), odds[shown]
