# A gap to be kept
# How far until the bodies are as near as a quarter, and not until they touch.
colltrans cast data/ellipsoid_a.obj data/ellipsoid_b.off --direction=-z --moving-pose=0.4,0.3,6 --keep 0.25 --picture "$1"
