# Every direction, proven
# Along which directions does a block leave the corner that three walls make? The corners of the
# region are exact; each dot is a direction that was asked by itself.
import sys

import matplotlib.pyplot as plt
import numpy as np

from colltrans import ConvexPolyhedron, Solid, free_directions

block = ConvexPolyhedron.cuboid([0, 0, 0], [1, 1, 1])
walls = [([-1, -1, -1], [2, 2, 0]), ([-1, -1, 0], [0, 2, 1.5]), ([0, -1, 0], [2, 0, 0.7])]
corner = Solid.from_pieces([ConvexPolyhedron.cuboid(*wall) for wall in walls])
free = free_directions(block, corner)

random = np.random.default_rng(3)
asked = random.normal(size=(3000, 3))
asked /= np.linalg.norm(asked, axis=1, keepdims=True)
says = np.array(free.says(asked))


def flat(directions):
    """The sphere as two hemispheres laid flat: z upwards is the middle, downwards the rim."""
    x, y, z = np.transpose(directions)
    away = np.arccos(np.clip(z, -1, 1)) / np.maximum(np.hypot(x, y), 1e-12)
    return x * away, y * away


figure, axes = plt.subplots(figsize=(5, 5))
for word, colour in (("free", "#0a8a68"), ("blocked", "#c9ced6")):
    axes.scatter(*flat(asked[says == word]), s=6, color=colour, label=word)
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
