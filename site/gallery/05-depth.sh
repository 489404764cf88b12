# How deep
# Two bodies overlap; the arrow is the shortest translation that parts them, over all directions.
colltrans depth data/dodecahedron.off data/bracket.obj --moving-pose=1.5,1,1.5 --picture "$1"
