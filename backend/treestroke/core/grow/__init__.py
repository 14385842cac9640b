"""Growth: fill the crown with branches by replacing branches with subtrees."""
