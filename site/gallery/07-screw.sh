# Time of impact of a screw motion
# The hull of a gear turns by 120 degrees and moves down by eight at the same time, until it touches a bracket.
colltrans motion data/gear_hull.stl data/bracket.obj --moving-pose=0,0,9 --screw 0,0,0 z 120 -8 --picture "$1"
