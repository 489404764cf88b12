# Clearance of a bolt in a plate
# The bodies are not convex: the shaft passes through the hole, and the head stops on the rim.
colltrans clearance data/bolt.stl --from data/plate.off --direction=-z --moving-pose=0,0,7 --picture "$1"
