# A contact that samples miss
# A thin blade swings past a thin post. Ten sampled poses are free, at a distance that
# suggests no contact. The proven first contact lies between two of them.
import sys

import matplotlib.pyplot as plt
import numpy as np

from colltrans import ConvexPolyhedron, Motion, distance_many, motion

blade = ConvexPolyhedron.cuboid([0, -0.01, -0.2], [2, 0.01, 0.2])
post = ConvexPolyhedron.cuboid([-0.02, 1.5, -1], [0.02, 1.54, 1])
swing = Motion.turn([0, 0, 0], [0, 0, 1], degrees=170)


def apart(times):
    poses = np.array([swing.at(float(time)).as_matrix() for time in times])
    return distance_many(blade, post, moving_pose=poses).upper


contact = motion(blade, post, swing)
fine, few = np.linspace(0, 1, 2000), np.linspace(0, 1, 10)
figure, axes = plt.subplots(figsize=(6, 3.4))
axes.plot(fine, apart(fine), color="#6f97d6", label="distance")
axes.plot(few, apart(few), "o", color="#c2600f", label="ten poses, all free")
axes.axvline(contact.lower, color="#b01657", label=f"first contact, proven: {contact.lower:.12f}")
axes.set(xlabel="time, of the motion", ylabel="distance")
axes.legend()
figure.savefig(sys.argv[1], bbox_inches="tight")
