# Cast of a convex body
# A dodecahedron moves along a slanted direction until it touches the slope of a bracket. The picture shows the contact point,
# the normal, and a ghost of the dodecahedron in contact.
colltrans cast data/dodecahedron.off data/bracket.obj --direction=-0.3,0.1,-1 \
    --moving-pose=6,1,9,0.2,0.3,0.1,0.9273618495495704 --picture "$1"
