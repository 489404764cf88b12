# Time of impact of a rotation
# A bracket turns about an axis by 150 degrees. The first contact is at 0.287 of the turn, proven over the whole motion.
colltrans motion data/bracket.obj data/dodecahedron.off --fixed-pose=-1,4,1 --turn 0,0,0 z 150 --picture "$1"
