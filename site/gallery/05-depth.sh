# Penetration depth
# Two bodies overlap. The arrow is the shortest translation that separates them, over all directions.
colltrans depth data/dodecahedron.off data/bracket.obj --moving-pose=1.5,1,1.5 --picture "$1"
