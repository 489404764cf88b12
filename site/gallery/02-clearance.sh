# A bolt and its plate
# Parts need not be convex: the shaft passes through the hole, and the head stops on the rim.
colltrans clearance data/bolt.stl --from data/plate.off --direction=-z --moving-pose=0,0,7 --picture "$1"
