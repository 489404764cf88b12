# Half a million grasps
# Free travel downwards of a gripper over three objects, for each position: columns of
# `clearance_many`. At white positions the gripper passes all objects.
import sys

import matplotlib.pyplot as plt
import numpy as np

from colltrans import ConvexPolyhedron, clearance_many

random = np.random.default_rng(4)
gripper = ConvexPolyhedron.cuboid([-0.06, -0.02, 0], [0.06, 0.02, 0.2])
objects = [
    ConvexPolyhedron(random.normal(size=(40, 3)) * 0.12 + at)
    for at in ([-0.4, -0.2, 0], [0.35, -0.25, 0], [0.05, 0.35, 0])
]

axis = np.linspace(-1, 1, 400)
starts = np.stack(np.broadcast_arrays(axis, axis[:, None], 2.0), axis=-1)
lowered = [
    clearance_many(gripper, body, [0, 0, -1], moving_pose=starts).stacked("distance")
    for body in objects
]

reach = np.min(lowered, axis=0)
figure, axes = plt.subplots(figsize=(5, 4.2))
image = axes.imshow(
    np.where(np.isfinite(reach), reach, np.nan), extent=(-1, 1, -1, 1), origin="lower"
)
figure.colorbar(image, label="free travel downwards")
axes.set(xlabel="x of the gripper", ylabel="y of the gripper")
figure.savefig(sys.argv[1], bbox_inches="tight")
