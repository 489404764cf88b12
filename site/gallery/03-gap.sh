# Minimum gap
# The cast stops where the distance of the bodies falls to 0.25, before they touch.
colltrans cast data/ellipsoid_a.obj data/ellipsoid_b.off --direction=-z --moving-pose=0.4,0.3,6 --min-gap 0.25 --picture "$1"
