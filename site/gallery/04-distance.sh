# Distance
# The closest points of two bodies at rest, with proven bounds of their distance.
colltrans distance data/dodecahedron.off data/bracket.obj --moving-pose=6,3,5 --picture "$1"
