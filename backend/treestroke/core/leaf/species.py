"""What one photo cannot tell of a tree: the shape of its leaves, how they sit, and the relief of its bark."""

SPECIES = (
    "ash",
    "beech",
    "birch",
    "cherry",
    "elm",
    "horse_chestnut",
    "larch",
    "linden",
    "locust",
    "maple",
    "oak",
    "pine",
    "plane",
    "poplar",
    "spruce",
    "walnut",
    "willow",
)
