# Removal directions
# The directions along which a block leaves a corner of three walls. The corners of the free region
# are exact; each dot is a direction that was tested by itself.
import sys

import matplotlib.pyplot as plt
import numpy as np

from colltrans import ConvexPolyhedron, Solid, free_directions

block = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
walls = [([-1, -1, -1], [2, 2, 0]), ([-1, -1, 0], [0, 2, 1.5]), ([0, -1, 0], [2, 0, 0.7])]
corner = Solid.from_pieces([ConvexPolyhedron.cuboid(*wall) for wall in walls])
free = free_directions(block, corner)

random = np.random.default_rng(3)
tested = random.normal(size=(3000, 3))
tested /= np.linalg.norm(tested, axis=1, keepdims=True)
says = np.array(free.says(tested))


def flat(directions):
    """Projects the sphere to a disc: z is the centre, -z the border."""
    x, y, z = np.transpose(directions)
    away = np.arccos(np.clip(z, -1, 1)) / np.maximum(np.hypot(x, y), 1e-12)
    return x * away, y * away


figure, axes = plt.subplots(figsize=(5, 5))
for word, colour in (("free", "#0a8a68"), ("blocked", "#c9ced6")):
    axes.scatter(*flat(tested[says == word]), s=6, color=colour, label=word)
for region in free.regions:
    axes.scatter(
        *flat(np.array(region["corners"])), color="#b01657", marker="s", label="corners, proven"
    )
axes.set_aspect("equal")
axes.axis("off")
axes.legend(loc="lower right")
low, high = free.free_share
axes.set_title(f"free: {100 * low:.6f} to {100 * high:.6f} % of all directions", fontsize=10)
figure.savefig(sys.argv[1], bbox_inches="tight")
