# What goes down a screw
# The hull of a gear turns by 120 degrees and goes down by eight meanwhile, until it lies on a bracket.
colltrans motion data/gear_hull.stl data/bracket.obj --moving-pose=0,0,9 --screw 0,0,0 z 120 -8 --picture "$1"
