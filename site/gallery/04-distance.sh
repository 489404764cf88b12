# How far apart
# Where the bodies are, without a direction: the shortest way between them, with proven bounds.
colltrans distance data/dodecahedron.off data/bracket.obj --moving-pose=6,3,5 --picture "$1"
